// SPDX-License-Identifier: BSD-3-Clause
// Ranges to anchors whose places are states, as of an ultra-wideband radio.
#pragma once

#include "rio/models/aiding_measurement.hpp"

namespace rio::test {

/// Place of an anchor in W [m].
struct Anchor : AuxiliaryBlock<3> {
  static constexpr const char* kName = "anchor";
  static constexpr double kSigma = 20.0;
  static constexpr double kWalk = 0.0;
  static constexpr bool kIndexed = true;
};
/// Range from the IMU to an anchor.
struct RangeModel {
  static constexpr const char* kName = "range";
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, Anchor>;
  struct Measurement {
    double range = 0.0;  ///< [m]
    double sigma = 1.0;  ///< [m]
  };
  using Scalar = Eigen::Matrix<double, 1, 1>;
  bool evaluate(const Measurement& z, const RigidPose& T_WB, const Anchor::Value& anchor, Scalar& r,
                Eigen::Matrix<double, 1, 9>* J, Scalar& R) const {
    const Vector3d line = anchor - T_WB.p;
    const double range = line.norm();
    if (range < 0.1) return false;
    r[0] = z.range - range;
    if (J != nullptr) {
      J->setZero();
      J->segment<3>(3) = -line.transpose() / range;
      J->segment<3>(6) = line.transpose() / range;
    }
    R(0, 0) = z.sigma * z.sigma;
    return true;
  }
};

}  // namespace rio::test

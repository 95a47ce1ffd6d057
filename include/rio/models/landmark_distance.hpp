// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: distance to a persistent landmark.
//
// e = R_BS^T (R_WB^T (l - p_WB) - p_BS),  u = e/|e|,  a = R_BS u
// (E1) h = |e|                                       Michalczyk et al. 2023, eq. 13-14
#pragma once

#include "rio/frontend/detection.hpp"
#include "rio/models/concept.hpp"
#include "rio/state/blocks.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

class LandmarkDistanceModel {
 public:
  static constexpr Model kModel = Model::kLandmarkDistance;
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, Extrinsics, Landmark>;

  struct Measurement {
    double range = 0.0;  ///< [m]
  };

  /// @param sigma_distance of the measured range [m]
  explicit LandmarkDistanceModel(double sigma_distance) : sigma_distance_(sigma_distance) {}

  static Measurement measurement(const Detection& d) { return {d.range}; }

  bool evaluate(const Measurement& z, const RigidPose& T_WB, const RigidPose& T_BS,
                const Vector3d& p_WL, ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                JacobianOf<kDim, kDim>& R) const noexcept {
    const Vector3d from_body = T_WB.R.transpose() * (p_WL - T_WB.p);
    const Vector3d e = T_BS.R.transpose() * (from_body - T_BS.p);
    const double h = e.norm();
    if (!(h > kMinRange)) return false;
    r[0] = z.range - h;  // (E1)
    R(0, 0) = sigma_distance_ * sigma_distance_;
    if (J == nullptr) return true;

    const Vector3d a = T_BS.R * (e / h);
    const Eigen::RowVector3d a_W = (T_WB.R * a).transpose();
    J->block<1, 3>(0, Blocks::column<BodyPose>()) = a.transpose() * skew(from_body);
    J->block<1, 3>(0, Blocks::column<BodyPose>() + 3) = -a_W;
    J->block<1, 3>(0, Blocks::column<Extrinsics>()).setZero();  // a range sees no rotation
    J->block<1, 3>(0, Blocks::column<Extrinsics>() + 3) = -a.transpose();
    J->block<1, 3>(0, Blocks::column<Landmark>()) = a_W;
    return true;
  }

 private:
  static constexpr double kMinRange = 1e-3;  // the direction to a point at the radar is undefined
  double sigma_distance_;
};

static_assert(MeasurementModel<LandmarkDistanceModel>);

}  // namespace rio

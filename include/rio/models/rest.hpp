// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: zero-velocity update (ZUPT): the body is at rest and the gyroscope reads its bias.
//
// (E1) 0 = R_WB^T v_WB + n_v, n_v the velocity tolerated at rest; in body axes, because a zero in
//      world axes would make the heading observable whenever the estimated velocity is not zero
// (E2) mean gyro = b_g + n_w, n_w white noise averaged over the time since the last scan
#pragma once

#include "rio/models/concept.hpp"
#include "rio/state/blocks.hpp"

namespace rio {

struct RestModel {
  static constexpr Model kModel = Model::kRest;
  static constexpr int kDim = 6;
  using Blocks = BlockList<BodyPose, BodyVelocity, GyroBias>;

  struct Measurement {
    Vector3d gyro_B = Vector3d::Zero();  ///< mean reading [rad/s]
    double sigma_velocity = 0.0;         ///< per axis [m/s]
    double sigma_rate = 0.0;             ///< per axis, of the mean [rad/s]
  };

  bool evaluate(const Measurement& z, const RigidPose& T_WB, const Vector3d& v_WB,
                const Vector3d& gyro_bias, ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                JacobianOf<kDim, kDim>& R) const noexcept;
};
static_assert(MeasurementModel<RestModel>);

}  // namespace rio

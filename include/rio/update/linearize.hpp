// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: from a model and an estimate to rows: picks each block's value and each block's column,
// whitens, and adds the column of the time offset.
//
// (E1) A scan is measured at its stamp minus t_d; the state is propagated to stamp - t_d^. The
//      error dt of the offset shifts the measurement to the state x - x' dt, for any model that
//      depends on the body state: dh/dt_d = -(dh/d[phi p] [w v] + dh/dv a)
// (E2) State s seconds earlier: R' = R Exp(-s w), p' = p - s v, v' = v - s a_W with a_W = R a_B.
//      Errors: dphi' = Exp(s w) dphi + s Jl(s w) db_g, dp' = dp - s dv,
//      dv' = dv + s [a_W] R dphi
#pragma once

#include <type_traits>

#include "rio/core/small_cholesky.hpp"
#include "rio/models/concept.hpp"
#include "rio/models/doppler.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

/// The Jacobian blocks of a state stepped back (E2).
struct StepBack {
  double seconds = 0.0;
  Matrix3d attitude = Matrix3d::Identity();  ///< of dphi' by dphi
  Matrix3d bias = Matrix3d::Zero();          ///< of dphi' by db_g
  Matrix3d velocity = Matrix3d::Zero();      ///< of dv' by dphi
};

/// The estimate with its rotations as matrices and its time derivative: computed once per scan.
struct LinearizationPoint {
  explicit LinearizationPoint(const Estimate& x);
  /// Another body state with the clones, landmarks and calibration of x.
  LinearizationPoint(const Estimate& x, const NavState& nav, const Vector3d& measured_gyro_B,
                     const SteadyMotion& steady_motion);

  /// Moves to the state `seconds` earlier, at constant rate and acceleration. Jacobians are then in
  /// the errors of that state (E2).
  void step_back(double seconds);

  /// The body is at rest: the derivative of the estimate is noise and set to zero, and so is the
  /// steady motion, which otherwise would still be that of before: Dopplers at rest tell nothing
  /// of the mounting.
  void stand() {
    pose_rate.setZero();
    accel_W.setZero();
    steady = SteadyMotion{};
  }

  /// Velocity of the radar in its own axes.
  Vector3d radar_velocity_S() const { return radar_velocity(T_WB, v_WB, gyro_B - gyro_bias, T_BS); }
  /// From this motion to the steady one, at which the columns of the calibration are evaluated.
  SteadyOffset steady_offset() const;

  const Estimate& estimate;  ///< for its clones and landmarks
  RigidPose T_WB;
  RigidPose T_BS;
  Vector3d v_WB;
  Vector3d gyro_bias;
  Vector3d gyro_B;   ///< measured [rad/s]
  Vector3d accel_W;  ///< [m/s^2]
  SteadyMotion steady;
  double doppler_scale = 0.0;             ///< left in corrected detections
  double elevation_error = 0.0;           ///< [rad]
  Eigen::Matrix<double, 6, 1> pose_rate;  ///< of the error [dphi, dp] [rad/s, m/s]
  StepBack step;                          ///< from the estimate to this state
};

/// Which clone and which landmark a measurement refers to, for the models that have one.
struct BlockIndex {
  int clone = 0;
  int landmark = 0;
};

/// Value of one block at x.
template <class Block>
const typename Block::Value& block_value(const LinearizationPoint& x, BlockIndex index) {
  if constexpr (std::is_same_v<Block, BodyPose>) return x.T_WB;
  if constexpr (std::is_same_v<Block, BodyVelocity>) return x.v_WB;
  if constexpr (std::is_same_v<Block, GyroBias>) return x.gyro_bias;
  if constexpr (std::is_same_v<Block, Extrinsics>) return x.T_BS;
  if constexpr (std::is_same_v<Block, DopplerScale>) return x.doppler_scale;
  if constexpr (std::is_same_v<Block, ElevationError>) return x.elevation_error;
  if constexpr (std::is_same_v<Block, ClonePose>) {
    return x.estimate.clones[static_cast<std::size_t>(index.clone)].T_WB;
  }
  if constexpr (std::is_same_v<Block, Landmark>) {
    return x.estimate.landmarks[static_cast<std::size_t>(index.landmark)].p_W;
  }
}

/// dh/dt_d of (E1).
template <int kDim, class... B>
ResidualOf<kDim> time_derivative(const JacobianOf<kDim, BlockList<B...>::kDof>& J,
                                 BlockList<B...> /*blocks*/, const LinearizationPoint& x) {
  using Blocks = BlockList<B...>;
  ResidualOf<kDim> d = ResidualOf<kDim>::Zero();
  const auto subtract = [&](int column, const auto& rate) {
    for (int k = 0; k < rate.size(); ++k) {
      for (int i = 0; i < kDim; ++i) d[i] -= J(i, column + k) * rate[k];
    }
  };
  if constexpr (Blocks::template has<BodyPose>()) {
    subtract(Blocks::template column<BodyPose>(), x.pose_rate);
  }
  if constexpr (Blocks::template has<BodyVelocity>()) {
    subtract(Blocks::template column<BodyVelocity>(), x.accel_W);
  }
  return d;
}

/// J dx as rows in the error state of `layout`.
template <int kDim, class LayoutT, class... B>
auto state_rows(const JacobianOf<kDim, BlockList<B...>::kDof>& J, BlockList<B...> blocks,
                const LinearizationPoint& x, BlockIndex index, const LayoutT& layout) {
  const auto column = [&]<class Block>(std::type_identity<Block>) {
    return layout.template column<Block>(std::is_same_v<Block, Landmark> ? index.landmark
                                                                         : index.clone);
  };
  return linear_rows<kDim>(J, blocks, {column(std::type_identity<B>{})...},
                           time_derivative<kDim>(J, blocks, x), layout.time_offset_column());
}

/// Divides by the root of R.
template <class M>
void whiten(Evaluation<M>* e) {
  const SmallCholesky<M::kDim> root(e->R);
  e->r = root.whitened(e->r);
  e->J = root.whitened(e->J);
}

/// Appends model M's rows for z to the open block of `batch`; rows of more than one dimension are
/// whitened. False if x is outside the model's domain.
template <MeasurementModel M, class LayoutT, class... B>
bool linearize(const M& model, const typename M::Measurement& z, BlockList<B...> blocks,
               const LinearizationPoint& x, BlockIndex index, const LayoutT& layout,
               RowBatch* batch) {
  Evaluation<M> e;
  if (!model.evaluate(z, block_value<B>(x, index)..., e.r, &e.J, e.R)) return false;
  if constexpr (M::kDim > 1) whiten(&e);
  auto rows = state_rows<M::kDim>(e.J, blocks, x, index, layout);
  for (int i = 0; i < M::kDim; ++i) {
    LinearRow& row = rows[static_cast<std::size_t>(i)];
    row.residual = e.r[i];
    row.variance = M::kDim > 1 ? 1.0 : e.R(0, 0);
    batch->push(row);
  }
  return true;
}

}  // namespace rio

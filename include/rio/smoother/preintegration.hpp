// SPDX-License-Identifier: BSD-3-Clause
// IMU preintegration: the samples between two states of the sliding window as one relative-motion
// measurement, independent of the states. With i the first state, j the last, T the time between:
//
// (E1) dR = R_i^T R_j,  dv = R_i^T (v_j - v_i - g T),  dp = R_i^T (p_j - p_i - v_i T - g T^2 / 2)
// (E2) A = d[dphi, dp, dv, dbg, dba]_j / d[..]_i and S, the covariance at j for an exact start:
//      product chain of the transitions and noises of propagate/strapdown.hpp
// (E3) at other biases, to first order: dR Exp(A_phi,g dbg),  dv + A_v,g dbg + A_v,a dba,
//      dp + A_p,g dbg + A_p,a dba
// All of it is strapdown integration without gravity from attitude I at rest: exact for constant
// rate and specific force over each step, and so are A and, up to its quadrature, S. Vectors are in
// the axes of body i. With M = blockdiag(I, R_i, R_i, I, I) the transition and the noise of the
// navigation error in W are M A M^T and M S M^T.
// Reference: Forster et al., 2017, eq. 33, 35, 44, 63, here with the bias walk correlated with the
// rest; Michalczyk et al., IROS 2024.
#pragma once

#include "rio/core/so3.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/types.hpp"

namespace rio {

/// Least noise densities that preintegration uses, units of ImuOptions: those of a tactical-grade
/// fibre-optic unit, which no small robot carries (0.01 deg/sqrt(h), 10 micro-g/sqrt(Hz), biases
/// that drift by 1 deg/h and 60 micro-g in an hour). They keep the covariance regular if an option
/// is zero, and its inverse below 1e17 over 5 ms or more: with rounding errors of some 10, small
/// compared with the information of one radar row (1e3 for a sigma of 3 cm or 3 cm/s).
namespace imu_floor {
inline constexpr double kGyroNoise = 3e-6;
inline constexpr double kGyroWalk = 1e-7;
inline constexpr double kAccelNoise = 1e-4;
inline constexpr double kAccelWalk = 1e-5;
}  // namespace imu_floor

/// Change from the first body frame to the last, without gravity and without the start velocity.
struct ImuIncrement {
  Quaternion delta_q = Quaternion::Identity();  ///< maps the last body frame to the first
  Vector3d delta_v = Vector3d::Zero();          ///< axes of the first body frame [m/s]
  Vector3d delta_p = Vector3d::Zero();          ///< axes of the first body frame [m]
};

/// Accumulates ImuSteps. No allocation. O(1) per step.
class Preintegration {
 public:
  /// Discards all steps; the next steps are corrected by these biases [rad/s, m/s^2].
  void reset(const Vector3d& gyro_bias, const Vector3d& accel_bias);

  /// Appends a step, which must begin where the previous one ended. Densities below imu_floor are
  /// raised to it.
  void step(const ImuStep& step, const ImuOptions& options);

  Time duration() const { return duration_; }
  /// The increments at the biases of reset() (E1).
  ImuIncrement increment() const {
    return {chain_.state.q_WB, chain_.state.v_WB, chain_.state.p_WB};
  }
  const Vector3d& gyro_bias() const { return chain_.state.gyro_bias; }    ///< of reset() [rad/s]
  const Vector3d& accel_bias() const { return chain_.state.accel_bias; }  ///< of reset() [m/s^2]
  /// A, 15x15, order of namespace body. (E2)
  Matrix15d transition() const { return chain_.transition(); }
  /// S, 15x15, order of namespace body, bias walk included. (E2)
  Matrix15d covariance() const { return chain_.noise(); }
  /// A step lay in a pause of the IMU longer than ImuOptions::max_gap.
  bool gap() const { return chain_.gap; }
  bool finite() const { return chain_.finite(); }

  /// Correction of delta_q for another gyro bias [rad]: the argument of Exp in (E3).
  Vector3d rotation_correction(const Vector3d& gyro_bias) const {
    return jacobians().attitude_gyro * (gyro_bias - chain_.state.gyro_bias);
  }

  /// The increment at other biases (E3). Its error grows with the square of the change; at constant
  /// rate w and specific force a it is at most |a| |dbg|^2 T^3 / 6 in velocity (tilt of a) and
  /// |w| |dbg|^2 T^3 / 12 in attitude. At 10 m/s^2 and 0.1 s, a change by 0.1 rad/s costs 0.02 mm/s
  /// (a hundredth of a sigma); at 1 s, 0.01 rad/s costs 0.2 mm/s (a twentieth). It is exact in the
  /// accelerometer bias alone.
  ImuIncrement corrected(const Vector3d& gyro_bias, const Vector3d& accel_bias) const;

  /// The blocks of A.
  const BodyTransition& jacobians() const { return chain_.from_start; }

 private:
  Propagation chain_;  // its W is the first body frame, free of gravity
  Time duration_{0};
};

}  // namespace rio

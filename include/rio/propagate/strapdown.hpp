// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: strapdown integration over a step of constant rate and specific force: mean, error-state
// transition and process noise, all in closed form.
//
// With w = gyro - b_g, a = accel - b_a, phi = w dt, g = (0, 0, -gravity) and Gamma_m of
// core/so3.hpp:
// (E1) R+ = R Gamma_0(phi),  v+ = v + R Gamma_1(phi) a dt + g dt,
//      p+ = p + v dt + R Gamma_2(phi) a dt^2 + g dt^2 / 2
// (E2) Phi: the exact derivative of (E1) with respect to the error state of namespace body
// (E3) Q = int_0^dt Phi(dt, s) G Q_c G^T Phi(dt, s)^T ds, in closed form to first order in phi
//      (relative error below |phi|^2 / 12, of the bias random walks' share |phi| / 3); a step that
//      rotates by more than 0.05 rad is split, into 100 parts at most
// Reference: Michalczyk et al. 2023, eq. 2 and 6 (with the sign of gravity corrected: W is z up).
#pragma once

#include "rio/core/so3.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/types.hpp"

namespace rio {

using Matrix15d = Eigen::Matrix<double, body::kSize, body::kSize>;

/// (E1) over dt seconds [rad/s, m/s^2]; does not touch state.time.
void integrate(const Vector3d& gyro_B, const Vector3d& accel_B, double dt, double gravity,
               NavState& state);

/// (E1) over one step, stamp included.
void integrate(const ImuStep& step, double gravity, NavState& state);

/// What the IMU says of the motion between two times: with body axes at the earlier one, a,
/// (E4) R = R_a D,  v = v_a + g s + R_a u,  p = p_a + v_a s + g s^2 / 2 + R_a w
/// Compare smoother/preintegration.hpp, which adds covariance and derivatives by the biases.
struct ImuIncrements {
  double seconds = 0.0;                  ///< s
  Matrix3d turn = Matrix3d::Identity();  ///< D
  Vector3d velocity = Vector3d::Zero();  ///< u [m/s]
  Vector3d position = Vector3d::Zero();  ///< w [m]
};

/// (E4)
/// @param biases state whose biases correct the samples
/// @param imu holds the samples from `from` to `to`
ImuIncrements imu_increments(Time from, Time to, const NavState& biases, const ImuBuffer& imu);

/// The blocks of (E2) that are neither zero nor identity, row_column; position by velocity is dt I.
/// Products of such transitions have the same form.
struct BodyTransition {
  Matrix3d attitude_attitude = Matrix3d::Identity();
  Matrix3d velocity_attitude = Matrix3d::Zero();
  Matrix3d position_attitude = Matrix3d::Zero();
  Matrix3d attitude_gyro = Matrix3d::Zero();
  Matrix3d velocity_gyro = Matrix3d::Zero();
  Matrix3d position_gyro = Matrix3d::Zero();
  Matrix3d velocity_accel = Matrix3d::Zero();
  Matrix3d position_accel = Matrix3d::Zero();
  double dt = 0.0;  ///< [s]

  /// The identity.
  BodyTransition() = default;
  /// From a state with attitude R over dt seconds at constant w [rad/s] and a [m/s^2].
  BodyTransition(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double dt);

  /// Appends a step with transition F: this <- F this.
  void advance(const BodyTransition& F);
  Matrix15d matrix() const;
};

/// The blocks of (E3): attitude and accelerometer bias are uncorrelated, the biases isotropic.
struct BodyNoise {
  Matrix3d attitude = Matrix3d::Zero();
  Matrix3d position_attitude = Matrix3d::Zero();
  Matrix3d velocity_attitude = Matrix3d::Zero();
  Matrix3d position = Matrix3d::Zero();
  Matrix3d velocity_position = Matrix3d::Zero();
  Matrix3d velocity = Matrix3d::Zero();
  Matrix3d attitude_gyro = Matrix3d::Zero();
  Matrix3d position_gyro = Matrix3d::Zero();
  Matrix3d velocity_gyro = Matrix3d::Zero();
  Matrix3d position_accel = Matrix3d::Zero();
  Matrix3d velocity_accel = Matrix3d::Zero();
  double gyro = 0.0;   ///< variance of each axis of the gyro bias [rad^2/s^2]
  double accel = 0.0;  ///< same, accelerometer bias [m^2/s^4]

  /// Appends a step with transition F and noise q: this <- F this F^T + q.
  void advance(const BodyTransition& F, const BodyNoise& q);
  Matrix15d matrix() const;
};

/// Power spectral densities of the four noises that drive the body error.
struct ProcessNoise {
  double gyro = 0.0;        ///< [(rad/s)^2/Hz]
  double accel = 0.0;       ///< [(m/s^2)^2/Hz]
  double gyro_walk = 0.0;   ///< [(rad/s^2)^2/Hz]
  double accel_walk = 0.0;  ///< [(m/s^3)^2/Hz]
};

/// Densities of a step: white noise as configured, or as measured if that is more
/// (imu_noise_meter.hpp). Inside a gap the motion between the two samples is unknown: a constant
/// error sigma of the mean rate (acceleration) accumulates over the gap T like the density
/// sigma^2 T, however the gap is cut into steps. A stamp jitter delta_i adds delta_i (a_{i-1} -
/// a_{i+1}) / 2 per step to the trapezoidal sum of the samples a_i; small without vibration.
ProcessNoise process_noise(const ImuOptions& o, const ImuStep& step);

/// (E3). The sensor noises are isotropic, so each enters by three columns of Phi: attitude (gyro),
/// velocity (accelerometer), and the two biases.
BodyNoise process_noise_covariance(const Matrix3d& R, const Vector3d& w, const Vector3d& a,
                                   double dt, const ProcessNoise& density);

/// F P F^T.
Matrix15d congruence(const Matrix15d& F, const Matrix15d& P);

/// Mean, transition and noise accumulated over several steps, to be applied to a covariance once.
struct Propagation {
  NavState state;
  BodyTransition from_start;  ///< product of the transitions (E2)
  BodyNoise added;            ///< accumulated noise (E3)
  bool gap = false;           ///< a step lay in a gap of the IMU

  Matrix15d transition() const { return from_start.matrix(); }
  Matrix15d noise() const { return added.matrix(); }

  /// Every value is a number.
  bool finite() const;

  /// Mean, transition and noise of one more step.
  void step(const ImuStep& step, const ImuOptions& options);
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/replacements.hpp"

#include <algorithm>
#include <cmath>

#include "rio/core/so3.hpp"

namespace rio {

void replace_velocity(const IndependentVelocity& found, double duration, double doubtful,
                      StateEstimate* state_estimate) {
  const Estimate& x = state_estimate->estimate();
  const Matrix3d R = x.T_WB().R;
  const Vector3d error = R * found.v_B - x.nav.v_WB;
  Covariance& P = state_estimate->covariance();
  P.inflate(body::kPosition, error.squaredNorm() * doubtful * doubtful);
  P.inflate_velocity(error.squaredNorm() + found.covariance.trace(), duration);
  state_estimate->measure_velocity(error, R * found.covariance * R.transpose());
  state_estimate->restart_steady_motion(found.v_B);
}

void replace_tilt(const IndependentGravity& found, double duration, const Options& options,
                  StateEstimate* state_estimate) {
  constexpr double kBefore = 4.0;  // the error existed before it was detectable [s]
  NavState& nav = state_estimate->estimate().nav;
  const double gravity = options.imu.gravity;
  const double off = (nav.q_WB * found.g_B - Vector3d(0.0, 0.0, -gravity)).norm();
  const Vector3d v_B = nav.q_WB.conjugate() * nav.v_WB;
  nav.q_WB = (rotation_between(nav.q_WB * found.g_B, -Vector3d::UnitZ()) * nav.q_WB).normalized();
  nav.v_WB = nav.q_WB * v_B;
  state_estimate->restart_steady_motion(v_B);
  const double angle = found.sigma / gravity;
  const double rate = angle / (duration + kBefore);
  // error of the velocity: its difference, and its rotation by the tilt error
  const double speed = (found.velocity.v_B - v_B).norm() + nav.v_WB.norm() * off / gravity;
  const double distance = 0.5 * off * duration * duration + speed * (duration + kBefore);
  const double accel = options.start.sigma_accel_bias;
  Covariance& P = state_estimate->covariance();
  P.inflate(body::kPosition, distance * distance);
  P.inflate(body::kAttitude, angle * angle);
  P.inflate(body::kGyroBias, rate * rate);
  P.inflate(body::kAccelBias, accel * accel);
}

void widen_heading(const LastingError& found, StateEstimate* state_estimate) {
  constexpr double kStep = 2.0;  // ratio of a step to its mean over the window it began in
  const NavState& nav = state_estimate->estimate().nav;
  const Vector3d up_B = nav.q_WB.conjugate() * Vector3d::UnitZ();
  const double heading = kStep * std::abs(found.error) * found.duration;
  const double speed = heading * nav.v_WB.norm();
  const double distance = 0.5 * heading * found.moved_W.norm();
  Covariance& P = state_estimate->covariance();
  P.inflate_along(body::kGyroBias, kStep * found.error * up_B);
  P.inflate_along(body::kAttitude, heading * up_B);
  P.inflate(body::kVelocity, speed * speed);
  P.inflate(body::kPosition, distance * distance);
}

void widen_biases(const LastingError& found, const Options& options,
                  StateEstimate* state_estimate) {
  // the step may be older than the window, and nothing has corrected the heading since
  constexpr double kBefore = 2.0;
  const double accel = options.start.sigma_accel_bias;
  const double gyro = options.start.sigma_gyro_bias;
  const double speed = std::max(accel * found.duration, std::abs(found.error));
  const double distance = 0.5 * speed * found.duration;
  const double turn = kBefore * gyro * found.duration;
  Covariance& P = state_estimate->covariance();
  P.inflate(body::kPosition, distance * distance);
  P.inflate(body::kVelocity, speed * speed);
  P.inflate(body::kAttitude, turn * turn);
  P.inflate(body::kGyroBias, gyro * gyro);
  P.inflate(body::kAccelBias, accel * accel);
}

void widen_position(double sigma, StateEstimate* state_estimate) {
  state_estimate->covariance().inflate(body::kPosition, sigma * sigma);
}

void widen_time_offset(std::size_t r, StateEstimate* state_estimate) {
  constexpr double kArrival = 0.02;  // of the mean of a few scans [s]
  const int column = state_estimate->layout().of_radar(r).time_offset_column();
  if (column >= 0) state_estimate->covariance().matrix()(column, column) += kArrival * kArrival;
}

void withdraw_alignment(double speed, const Options& options, StateEstimate* state_estimate) {
  const double tilt = speed / options.start.duration / options.imu.gravity;
  const double bias = options.start.sigma_gyro_bias;
  state_estimate->estimate().nav.gyro_bias.setZero();
  state_estimate->covariance().inflate(body::kGyroBias, bias * bias);
  state_estimate->covariance().inflate(body::kAttitude, tilt * tilt);
}

}  // namespace rio

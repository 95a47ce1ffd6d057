// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/preintegration.hpp"

#include <algorithm>

namespace rio {

void Preintegration::reset(const Vector3d& gyro_bias, const Vector3d& accel_bias) {
  chain_ = Propagation{};
  chain_.state.gyro_bias = gyro_bias;
  chain_.state.accel_bias = accel_bias;
  duration_ = Time{0};
}

void Preintegration::step(const ImuStep& step, const ImuOptions& options) {
  chain_.step(step, weightless(options));
  duration_ += step.end - step.begin;
}

ImuIncrement Preintegration::corrected(const Vector3d& gyro_bias,
                                       const Vector3d& accel_bias) const {
  const Vector3d dbg = gyro_bias - chain_.state.gyro_bias;
  const Vector3d dba = accel_bias - chain_.state.accel_bias;
  ImuIncrement out = increment();
  out.delta_q = (out.delta_q * quaternion_exp(rotation_correction(gyro_bias))).normalized();
  out.delta_v += jacobians().velocity_gyro * dbg + jacobians().velocity_accel * dba;
  out.delta_p += jacobians().position_gyro * dbg + jacobians().position_accel * dba;
  return out;
}

NavState Preintegration::predict(const NavState& from, double gravity) const {
  const ImuIncrement d = corrected(from.gyro_bias, from.accel_bias);
  const double T = to_seconds(duration_);
  const Matrix3d R = from.q_WB.toRotationMatrix();
  const Vector3d g(0.0, 0.0, -gravity);
  NavState out = from;
  out.time += duration_;
  out.q_WB = (from.q_WB * d.delta_q).normalized();
  out.p_WB += R * d.delta_p + (from.v_WB + 0.5 * T * g) * T;
  out.v_WB += R * d.delta_v + g * T;
  return out;
}

ImuOptions Preintegration::weightless(ImuOptions options) {
  options.gravity = 0.0;
  options.gyro_noise_density = std::max(options.gyro_noise_density, imu_floor::kGyroNoise);
  options.gyro_random_walk = std::max(options.gyro_random_walk, imu_floor::kGyroWalk);
  options.accel_noise_density = std::max(options.accel_noise_density, imu_floor::kAccelNoise);
  options.accel_random_walk = std::max(options.accel_random_walk, imu_floor::kAccelWalk);
  return options;
}

}  // namespace rio

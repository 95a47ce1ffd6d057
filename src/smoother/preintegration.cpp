// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/preintegration.hpp"

#include <algorithm>

namespace rio {

namespace {

ImuOptions weightless(ImuOptions options) {
  options.gravity = 0.0;
  options.gyro_noise_density = std::max(options.gyro_noise_density, imu_floor::kGyroNoise);
  options.gyro_random_walk = std::max(options.gyro_random_walk, imu_floor::kGyroWalk);
  options.accel_noise_density = std::max(options.accel_noise_density, imu_floor::kAccelNoise);
  options.accel_random_walk = std::max(options.accel_random_walk, imu_floor::kAccelWalk);
  return options;
}

}  // namespace

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

}  // namespace rio

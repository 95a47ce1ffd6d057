// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/moving_start.hpp"

#include <algorithm>

#include "rio/core/motion.hpp"

namespace rio {

std::optional<Alignment> MovingStart::add(const ImuSample& sample) {
  if (!begin_) {
    begin_ = newest_ = sample.time;
    up_B_ = sample.accel_B;
  }
  const double dt = to_seconds(sample.time - newest_);
  const double elapsed = to_seconds(sample.time - *begin_);
  newest_ = sample.time;
  up_B_ = quaternion_exp(-dt * sample.gyro_B) * up_B_;         // (E1)
  const double averaged = std::min(elapsed, start_.duration);  // how long the mean is [s]
  if (dt > 0.0) up_B_ += (sample.accel_B - up_B_) * std::min(1.0, dt / averaged);
  if (start_.max_wait <= 0.0 || elapsed < start_.max_wait || !(up_B_.norm() > 0.0)) return {};
  Alignment out;
  out.state.time = sample.time;
  const Vector3d y = up_B_.normalized();
  out.state.q_WB = level(y);  // (E2)
  const Matrix3d along = y * y.transpose();
  const double tilt = kVelocityChange / (averaged * gravity_);
  BodyCovariance& P = out.covariance;
  P.block<3, 3>(body::kAttitude, body::kAttitude) =
      tilt * tilt * (Matrix3d::Identity() - along) + start_.sigma_yaw * start_.sigma_yaw * along;
  const auto set = [&P](int block, double sigma) {
    P.block<3, 3>(block, block) = sigma * sigma * Matrix3d::Identity();
  };
  set(body::kPosition, start_.sigma_position);
  set(body::kVelocity, kVelocity);
  set(body::kGyroBias, start_.sigma_gyro_bias);
  set(body::kAccelBias, start_.sigma_accel_bias);
  return out;
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/restart.hpp"

#include <algorithm>
#include <cmath>

#include "rio/core/so3.hpp"

namespace rio {

namespace {

StartOptions in_motion(StartOptions start, double duration) {
  start.duration = start.max_wait = duration;
  return start;
}

}  // namespace

Restart::Restart(const StartOptions& start, const ImuOptions& imu)
    : gravity_(imu.gravity),
      gap_rate_sigma_(imu.gap_rate_sigma),
      tilt_(in_motion(start, kDuration), imu.gravity) {}

Restart::Before Restart::estimate(const NavState& x, const BodyCovariance& P) {
  const Matrix3d attitude = P.block<3, 3>(body::kAttitude, body::kAttitude);
  return {x, std::sqrt(P.diagonal().segment<3>(body::kPosition).maxCoeff()),
          std::sqrt(attitude_variance(x.q_WB, attitude).heading)};
}

void Restart::begin(const NavState& x, const BodyCovariance& P, bool diverged, Time now) {
  active_ = true;
  tilt_.reset();
  if (before_pause_) {
    before_ = *before_pause_;
    newest_ = now;
    const double pause = to_seconds(now - before_.state.time);
    before_.sigma_yaw = std::hypot(before_.sigma_yaw, gap_rate_sigma_ * pause);
  } else {
    before_ = estimate(x, P);
    newest_ = x.time;
    if (diverged) {
      before_.sigma_yaw = kAnyYaw;
      before_.sigma_position += kDetectionDelay * x.v_WB.norm();
    }
  }
  before_.sigma_yaw = std::min(before_.sigma_yaw, kAnyYaw);
  before_pause_.reset();
}

std::optional<Alignment> Restart::add(const ImuSample& sample, bool pause) {
  const double dt = std::max(0.0, to_seconds(sample.time - newest_));
  newest_ = sample.time;
  NavState& before = before_.state;
  before.q_WB =
      (before.q_WB * quaternion_exp(dt * (sample.gyro_B - before.gyro_bias))).normalized();
  if (pause) tilt_.reset();
  std::optional<Alignment> found = tilt_.add(sample);
  if (!found) return found;
  if (!(std::abs(tilt_.force() / gravity_ - 1.0) < kNoGravity)) {
    tilt_.reset();
    return std::nullopt;
  }
  const Vector3d up_B = found->state.q_WB.conjugate() * Vector3d::UnitZ();
  NavState& x = found->state;
  x.q_WB = (rotation_between(before.q_WB * up_B, Vector3d::UnitZ()) * before.q_WB).normalized();
  x.p_WB = before.p_WB;
  const double seconds = to_seconds(sample.time - before.time);
  const double speed = before.v_WB.norm() + kSpeed;
  const double sigma = std::hypot(before_.sigma_position, seconds * speed);
  BodyCovariance& P = found->covariance;
  P.block<3, 3>(body::kPosition, body::kPosition) = sigma * sigma * Matrix3d::Identity();
  P.block<3, 3>(body::kAttitude, body::kAttitude) +=
      before_.sigma_yaw * before_.sigma_yaw * up_B * up_B.transpose();
  active_ = false;
  return found;
}

}  // namespace rio

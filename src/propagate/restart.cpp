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

Restart::Restart(const StartOptions& start, double gravity)
    : gravity_(gravity), tilt_(in_motion(start, kDuration), gravity) {}

void Restart::begin(const NavState& x, const BodyCovariance& P, bool diverged) {
  active_ = true;
  tilt_.reset();
  before_ = x;
  newest_ = x.time;
  const double yaw =
      std::sqrt(attitude_variance(x.q_WB, P.block<3, 3>(body::kAttitude, body::kAttitude)).heading);
  sigma_yaw_ = diverged ? kAnyYaw : std::min(yaw, kAnyYaw);
  sigma_position_ = std::sqrt(P.diagonal().segment<3>(body::kPosition).maxCoeff());
  if (diverged) sigma_position_ += kUnnoticed * x.v_WB.norm();
}

std::optional<Alignment> Restart::add(const ImuSample& sample, bool pause) {
  const double dt = std::max(0.0, to_seconds(sample.time - newest_));
  newest_ = sample.time;
  before_.q_WB =
      (before_.q_WB * quaternion_exp(dt * (sample.gyro_B - before_.gyro_bias))).normalized();
  if (pause) tilt_.reset();
  std::optional<Alignment> found = tilt_.add(sample);
  if (!found) return found;
  if (!(std::abs(tilt_.force() / gravity_ - 1.0) < kNoGravity)) {
    tilt_.reset();
    return std::nullopt;
  }
  const Vector3d up_B = found->state.q_WB.conjugate() * Vector3d::UnitZ();
  NavState& x = found->state;
  x.q_WB = (rotation_between(before_.q_WB * up_B, Vector3d::UnitZ()) * before_.q_WB).normalized();
  x.p_WB = before_.p_WB;
  const double seconds = to_seconds(sample.time - before_.time);
  const double speed = before_.v_WB.norm() + kSpeed;
  const double sigma = std::hypot(sigma_position_, seconds * speed);
  BodyCovariance& P = found->covariance;
  P.block<3, 3>(body::kPosition, body::kPosition) = sigma * sigma * Matrix3d::Identity();
  P.block<3, 3>(body::kAttitude, body::kAttitude) +=
      sigma_yaw_ * sigma_yaw_ * up_B * up_B.transpose();
  active_ = false;
  return found;
}

}  // namespace rio

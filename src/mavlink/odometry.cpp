// SPDX-License-Identifier: BSD-3-Clause
#include "rio/mavlink/odometry.hpp"

#include <algorithm>
#include <cmath>

#include "rio/mavlink/axes.hpp"

namespace rio::mavlink {
namespace {

constexpr double kMost = 1e9;  // products of such values fit a float
enum State : std::uint8_t { kCalibrating = 2, kActive = 4, kCritical = 5, kTermination = 8 };

HealthState state_of(const Health& health, Content content) {
  return content == Content::kVelocity ? health.velocity : health.state;
}

/// kAll or kVelocity.
Content usable(const Health& health, Content content) {
  if (content != Content::kAllOrVelocity) return content;
  return health.state == HealthState::kLost ? Content::kVelocity : Content::kAll;
}

template <class Derived>
bool is_sound(const Eigen::MatrixBase<Derived>& values) {
  return (values.array().abs() < kMost).all();  // false for NaN
}

std::array<float, 3> floats(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

void put_pose(const NavState& now, const BodyCovariance& P, OdometryMessage* message) {
  const Quaternion q = attitude_flu_to_frd(now.q_WB);
  message->position = floats(flu_to_frd(now.p_WB));
  message->q = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                static_cast<float>(q.z())};
  message->pose_covariance = upper_triangle(covariance_flu_to_frd(pose_covariance(now.q_WB, P)));
}

void put_no_pose(OdometryMessage* message) {
  message->position.fill(kUnknown);
  message->q.fill(kUnknown);
  message->pose_covariance.fill(kUnknown);
}

}  // namespace

std::optional<OdometryMessage> odometry_message(const NavState& now, const BodyCovariance& P,
                                                const Health& health,
                                                const std::optional<Vector3d>& gyro_B,
                                                double gyro_sigma, Content wanted) {
  const Content content = usable(health, wanted);
  const HealthState state = state_of(health, content);
  if (state == HealthState::kInitializing || state == HealthState::kLost) return std::nullopt;
  const Vector3d rates = gyro_B.value_or(now.gyro_bias) - now.gyro_bias;
  const bool sound = is_sound(now.q_WB.coeffs()) && is_sound(now.p_WB) && is_sound(now.v_WB) &&
                     is_sound(rates) && is_sound(P) && std::abs(gyro_sigma) < kMost;
  if (!sound || now.time < Time{0}) return std::nullopt;
  OdometryMessage message;
  message.time_usec = static_cast<std::uint64_t>(now.time.count() / 1000);
  content == Content::kAll ? put_pose(now, P, &message) : put_no_pose(&message);
  message.velocity = floats(flu_to_frd(now.q_WB.conjugate() * now.v_WB));
  message.rates = floats(flu_to_frd(rates));
  Matrix6d twist = covariance_flu_to_frd(twist_covariance(now, P, gyro_sigma));
  if (!gyro_B) {
    message.rates.fill(kUnknown);
    twist.rightCols<3>().setConstant(static_cast<double>(kUnknown));
  }
  message.velocity_covariance = upper_triangle(twist);
  message.reset_counter = health.reset_counter;
  message.quality = static_cast<std::int8_t>(std::clamp(health.quality, 1, 100));
  return message;
}

Heartbeat heartbeat(const Health& health, Content wanted) {
  Heartbeat message;
  const Content content = usable(health, wanted);
  switch (state_of(health, content)) {
    case HealthState::kInitializing:
      message.system_status = kCalibrating;
      break;
    case HealthState::kOk:
      message.system_status =
          content == Content::kVelocity && wanted != content ? kCritical : kActive;
      break;
    case HealthState::kDegraded:
    case HealthState::kDeadReckoning:
      message.system_status = kCritical;
      break;
    case HealthState::kLost:
      message.system_status = kTermination;
      break;
  }
  return message;
}

RateLimiter::RateLimiter(double rate)
    : period_(from_seconds(1.0 / (rate > 1e-3 ? std::min(rate, 1e6) : 1e-3))) {}

bool RateLimiter::due(Time stamp) {
  const bool again = !started_ || stamp < last_;
  last_ = stamp;
  started_ = true;
  if (!again && stamp < next_) return false;
  const bool late = again || stamp - next_ >= period_;
  next_ = (late ? stamp : next_) + period_;
  return true;
}

}  // namespace rio::mavlink

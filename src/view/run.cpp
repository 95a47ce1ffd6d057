// SPDX-License-Identifier: BSD-3-Clause
#include "view/run.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rio::view {

std::string reasons_text(const Health& health) {
  std::string text;
  for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
    const auto reason = static_cast<HealthReason>(i);
    if (!health.because(reason)) continue;
    if (!text.empty()) text += ", ";
    text += to_string(reason);
  }
  return text;
}

Pose laid_over(const eval::StampedPose& truth, const eval::StampedPose& estimate) {
  const Matrix3d R = (estimate.q * truth.q.conjugate()).toRotationMatrix();
  const double yaw = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
  Pose T;
  T.rotation = Quaternion(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
  T.translation = estimate.p - T.rotation * truth.p;
  return T;
}

const std::vector<Event>& EventWatch::after_scan(const Odometry& odometry) {
  using enum EventKind;
  const UpdateReport& report = odometry.report();
  time_ = odometry.at_scan().time;
  events_.clear();
  if (!started_) add(kStart, false, "first scan used");
  started_ = true;
  if (mounting_unknown_ && !report.mounting_unknown) {
    add(kStart, false, "the mounting of the radar was found");
  }
  mounting_unknown_ = report.mounting_unknown;
  if (report.position_reopened > 0.0) {
    add(kReopened, false,
        fmt::format("the sigma of the position was widened by {:.2f} m", report.position_reopened));
  }
  look(odometry);
  return events_;
}

const std::vector<Event>& EventWatch::after_imu(const Odometry& odometry) {
  time_ = odometry.now().time;
  events_.clear();
  look(odometry);
  return events_;
}

void EventWatch::look(const Odometry& odometry) {
  using enum EventKind;
  const Counters& counters = odometry.counters();
  const auto count = [&](std::uint64_t Counters::*counter, EventKind kind, const char* text) {
    const std::uint64_t now = counters.*counter;
    const std::uint64_t before = counters_.*counter;
    if (now <= before) return;  // a reset clears the counters
    add(kind, kind == kReset || kind == kFailed,
        now - before == 1 ? text : fmt::format("{} ({} times)", text, now - before));
  };
  count(&Counters::imu_gaps, kGap, "the IMU has paused");
  count(&Counters::clock_restarts, kReset, "the clock of the sensors restarted");
  count(&Counters::radar_clock_steps, kReset, "the clock of a radar stepped");
  count(&Counters::velocity_resets, kReset, "the velocity was replaced");
  count(&Counters::attitude_resets, kReset,
        "tilt was replaced, or the sigma of heading and gyro bias widened");
  count(&Counters::restarts, kReset, "the tilt was lost and found again");
  count(&Counters::updates_failed, kFailed, "an update failed");
  count(&Counters::scans_late, kDropped, "a late scan was dropped");
  count(&Counters::scans_ahead, kDropped, "a scan was too far ahead");
  count(&Counters::scans_duplicate, kDropped, "a scan came twice");
  count(&Counters::scans_overflow, kDropped, "too many scans were waiting");
  count(&Counters::scans_non_finite, kDropped, "a scan was not finite");
  count(&Counters::imu_frozen, kDropped, "IMU samples were frozen");
  count(&Counters::imu_out_of_range, kDropped, "IMU samples were out of range");
  count(&Counters::imu_stale, kDropped, "IMU samples came twice or too late");
  counters_ = counters;
  const Health health = odometry.health();
  if (health.state == health_) return;
  health_ = health.state;
  const std::string why = reasons_text(health);
  add(kHealth, health_ == HealthState::kLost,
      fmt::format("health: {}{}{}", to_string(health_), why.empty() ? "" : ", ", why));
}

}  // namespace rio::view

// SPDX-License-Identifier: BSD-3-Clause
#include "view/record.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rio::view {

void take_record(const Odometry& odometry, ScanRecord* out) {
  const UpdateReport& report = odometry.report();
  out->stamp = report.time;
  out->radar = report.radar;
  out->state = odometry.at_scan();
  out->covariance = odometry.covariance();
  out->T_BS = odometry.extrinsics(report.radar);
  out->report = report;
  out->points = odometry.points();
  out->landmarks = odometry.landmarks();
  out->counters = odometry.counters();
}

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

void EventWatch::add(const ScanRecord& record, EventKind kind, bool serious,
                     const std::string& text) {
  events_.push_back({record.state.time, kind, serious, text});
}

void EventWatch::count(const ScanRecord& record, std::uint64_t Counters::*counter, EventKind kind,
                       const char* text) {
  const std::uint64_t now = record.counters.*counter;
  const std::uint64_t before = counters_.*counter;
  if (now <= before) return;  // a reset clears the counters
  add(record, kind, kind == EventKind::kReset || kind == EventKind::kFailed,
      now - before == 1 ? text : fmt::format("{} ({} times)", text, now - before));
}

const std::vector<Event>& EventWatch::look(const ScanRecord& record) {
  events_.clear();
  if (!started_) add(record, EventKind::kStart, false, "first scan used");
  started_ = true;
  const UpdateReport& report = record.report;
  if (mounting_unknown_ && !report.mounting_unknown) {
    add(record, EventKind::kStart, false, "the mounting of the radar was found");
  }
  mounting_unknown_ = report.mounting_unknown;
  if (report.imu_gap) add(record, EventKind::kGap, false, "the IMU paused before this scan");
  count(record, &Counters::clock_restarts, EventKind::kReset, "the clock of the sensors restarted");
  count(record, &Counters::radar_clock_steps, EventKind::kReset, "the clock of a radar stepped");
  count(record, &Counters::velocity_resets, EventKind::kReset, "the velocity was replaced");
  count(record, &Counters::attitude_resets, EventKind::kReset,
        "tilt, heading or biases were re-initialised");
  count(record, &Counters::restarts, EventKind::kReset, "the tilt was lost and found again");
  if (report.position_reopened > 0.0) {
    add(record, EventKind::kReopened, false,
        fmt::format("the position was re-opened by {:.2f} m", report.position_reopened));
  }
  count(record, &Counters::updates_failed, EventKind::kFailed, "an update failed");
  count(record, &Counters::scans_late, EventKind::kDropped, "a late scan was dropped");
  count(record, &Counters::scans_ahead, EventKind::kDropped, "a scan was too far ahead");
  count(record, &Counters::scans_duplicate, EventKind::kDropped, "a scan came twice");
  count(record, &Counters::scans_overflow, EventKind::kDropped, "too many scans were waiting");
  count(record, &Counters::scans_non_finite, EventKind::kDropped, "a scan was not finite");
  count(record, &Counters::imu_frozen, EventKind::kDropped, "IMU samples were frozen");
  count(record, &Counters::imu_out_of_range, EventKind::kDropped, "IMU samples were out of range");
  count(record, &Counters::imu_stale, EventKind::kDropped, "IMU samples came twice or too late");
  if (report.health.state != health_) {
    health_ = report.health.state;
    const std::string why = reasons_text(report.health);
    add(record, EventKind::kHealth, health_ == HealthState::kLost,
        fmt::format("health: {}{}{}", to_string(health_), why.empty() ? "" : ", ", why));
  }
  counters_ = record.counters;
  return events_;
}

void RunRecorder::begin(const RunStart& start) {
  for (RunSink* sink : sinks_) sink->begin(start);
}

void RunRecorder::add(const Odometry& odometry) {
  if (sinks_.empty()) return;
  take_record(odometry, &record_);
  const std::vector<Event>& events = watch_.look(record_);
  for (RunSink* sink : sinks_) sink->add(record_, events);
}

void RunRecorder::close() {
  for (RunSink* sink : sinks_) sink->close();
}

}  // namespace rio::view

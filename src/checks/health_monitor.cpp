// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/health_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "rio/core/motion.hpp"
#include "rio/core/so3.hpp"
#include "rio/options.hpp"

namespace rio {

namespace {

/// The quantities a reason affects, and whether it can make them kLost.
struct Effect {
  bool position;
  bool velocity;
  bool heading;
  bool loses;
};

/// Position, velocity, heading, loses; in the order of HealthReason.
constexpr std::array<Effect, kHealthReasonCount> kEffects = {{
    {true, true, false, false},    // kRadarSilent
    {true, true, false, false},    // kFewDetections
    {true, true, false, false},    // kOutliers
    {true, true, false, true},     // kGated
    {true, true, false, false},    // kInnovations
    {true, true, false, true},     // kVelocityContradicted
    {true, true, true, true},      // kTiltContradicted
    {true, true, true, true},      // kReopened
    {true, true, true, true},      // kImuGaps
    {true, false, false, true},    // kUncertainPosition
    {true, true, false, true},     // kUncertainVelocity
    {true, false, true, true},     // kUncertainHeading
    {true, true, true, true},      // kUncertainTilt
    {true, true, true, true},      // kTooFast
    {true, true, false, false},    // kCalibration
    {true, true, true, true},      // kNumerical
    {true, true, true, false},     // kAiding
    {false, false, false, false},  // kOneRadarSilent: as good as the others make it
}};

double largest_sigma(const BodyCovariance& P, int at, int size) {
  return std::sqrt(std::max(0.0, P.diagonal().segment(at, size).maxCoeff()));
}

}  // namespace

void HealthMonitor::reset(Time time) {
  const std::uint8_t resets = health_.reset_counter;
  *this = HealthMonitor(radars_);
  health_.reset_counter = static_cast<std::uint8_t>(resets + 1);
  now_ = last_used_ = not_gated_ = time;
  last_.fill(time);
}

void HealthMonitor::fade(Time now) {
  const double seconds = std::max(0.0, to_seconds(now - now_));
  if (now > now_) now_ = now;
  const double kept = std::exp(-seconds / kMemory);
  for (double* sum :
       {&detections_, &static_detections_, &rows_used_, &rows_gated_, &nis_, &gaps_}) {
    *sum *= kept;
  }
  gaps_ += std::exchange(new_gaps_, 0.0);  // not faded by the pause itself
  const double kept_aiding = std::exp(-seconds / kAidingMemory);
  for (double* sum : {&aiding_used_, &aiding_gated_, &aiding_nis_}) *sum *= kept_aiding;
  const double kept_step = std::exp(-seconds / kStepMemory);
  steps_ *= kept_step;
  failures_ *= kept_step;
}

void HealthMonitor::observe(const UpdateReport& report, const Estimate& x,
                            const BodyCovariance& P_body) {
  fade(x.nav.time);
  if (report.velocity_reset || report.attitude_reset) add_step();
  if (report.status != Status::kOk) failures_ += 1.0;
  int used = 0;  // of the radar: what other sensors measure does not replace it
  for (std::size_t i = 0; i < report.models.size(); ++i) {
    if (static_cast<Model>(i) == Model::kAiding) continue;
    used += report.models[i].rows_used;
    rows_gated_ += report.models[i].rows_gated;
    nis_ += report.models[i].nis;
  }
  rows_used_ += used;
  detections_ += report.detections_kept;
  static_detections_ += report.static_detections;
  if (used > 0) last_used_ = x.nav.time;
  last_[report.radar] = x.nav.time;
  severity(HealthReason::kVelocityContradicted) = report.velocity_contradicted / kVelocityTime;
  severity(HealthReason::kTiltContradicted) = report.tilt_contradicted / kTiltTime;
  calibration_[report.radar] = std::max(calibration_doubt(report), clock_doubt(report, x.nav.time));
  severity(HealthReason::kCalibration) =
      *std::max_element(calibration_.begin(), calibration_.end());
  judge_aiding(report);
  judge_scans(x.nav.time, Time{0});
  judge_sigmas(x, P_body);
  const bool known = severity(HealthReason::kUncertainVelocity) < kHealthLost &&
                     severity(HealthReason::kUncertainTilt) < kHealthLost;
  begun_ = (begun_ || (rows_used_ > kFewRows && known)) && !report.mounting_unknown;
  conclude();
}

void HealthMonitor::observe_aiding(const UpdateReport& report) {
  fade(report.time);
  judge_aiding(report);
  conclude();
}

void HealthMonitor::judge_aiding(const UpdateReport& report) {
  const ModelReport& aiding = report.models[static_cast<std::size_t>(Model::kAiding)];
  aiding_used_ += aiding.rows_used;
  aiding_gated_ += aiding.rows_gated;
  aiding_nis_ += aiding.nis;
  const double gated = aiding_gated_ / std::max(aiding_used_ + aiding_gated_, kFewAiding);
  const double nis = aiding_nis_ / std::max(aiding_used_, kFewAiding);
  severity(HealthReason::kAiding) = std::max(gated / kGated, nis / kInnovations);
}

double HealthMonitor::calibration_doubt(const UpdateReport& report) const {
  double doubt = 0.0;
  for (const CalibrationReport& c : report.calibration) {
    if (c.observability == Observability::kAtLimit) return 1.0;
    if (c.observability != Observability::kDoubtful) continue;
    doubt = std::max(doubt, std::abs(c.value) / (kCalibrationLimit * c.prior_sigma));
  }
  return doubt;
}

double HealthMonitor::clock_doubt(const UpdateReport& report, Time now) {
  const CalibrationReport& c =
      report.calibration[static_cast<std::size_t>(Calibration::kTimeOffset)];
  if (c.observability == Observability::kNotEstimated) return 0.0;
  PastOffsets& past = offsets_[report.radar];
  if (past.empty() || now - past.back().time >= kClockStep) {
    if (past.full()) past.erase(0);
    (void)past.push_back({now, c.value, c.sigma});
  }
  return std::abs(c.value - past.front().value) / (kClockSigmas * past.front().sigma);
}

void HealthMonitor::wait(Time now, Time pause, const Estimate& x, const BodyCovariance& P_body) {
  fade(now);
  judge_scans(now, pause);
  judge_sigmas(x, P_body);
  conclude();
}

void HealthMonitor::judge_scans(Time now, Time pause) {
  severity(HealthReason::kRadarSilent) = to_seconds(now + pause - last_used_) / kSilence;
  const Time oldest = *std::min_element(last_.begin(), last_.begin() + radars_);
  severity(HealthReason::kOneRadarSilent) =
      radars_ > 1 ? to_seconds(now + pause - oldest) / kOneSilence : 0.0;
  severity(HealthReason::kFewDetections) = kFewRows / std::max(rows_used_, 1e-3);
  const double others = detections_ - static_detections_;
  severity(HealthReason::kOutliers) = others / std::max(detections_, 10.0) / kOutliers;
  if (unusual_gated_share() == 0.0) not_gated_ = now;
  severity(HealthReason::kGated) =
      std::max(gated_share() / kGated, to_seconds(now - not_gated_) / kGatedTime);
  severity(HealthReason::kInnovations) = nis_ / std::max(rows_used_, 10.0) / kInnovations;
  severity(HealthReason::kImuGaps) = (gaps_ + to_seconds(pause)) / kLostTime;
  severity(HealthReason::kReopened) = steps_;
  severity(HealthReason::kNumerical) = 2.0 * failures_;
}

void HealthMonitor::judge_sigmas(const Estimate& x, const BodyCovariance& P) {
  const AttitudeVariance attitude =
      attitude_variance(x.nav.q_WB, P.block<3, 3>(body::kAttitude, body::kAttitude));
  severity(HealthReason::kUncertainPosition) =
      largest_sigma(P, body::kPosition, 3) / (kPosition + kPositionShare * x.distance_travelled);
  severity(HealthReason::kUncertainVelocity) = largest_sigma(P, body::kVelocity, 3) / kVelocity;
  severity(HealthReason::kUncertainHeading) = std::sqrt(attitude.heading) / kHeading;
  severity(HealthReason::kUncertainTilt) = std::sqrt(attitude.tilt) / kTilt;
  severity(HealthReason::kTooFast) = x.nav.v_WB.squaredNorm() / (kFastestRobot * kFastestRobot);
}

void HealthMonitor::conclude() {
  double largest = 0.0;
  const auto worst = [&](bool Effect::*doubted) {
    HealthState state = HealthState::kOk;
    for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
      const auto reason = static_cast<HealthReason>(i);
      const double s = severity(reason);
      const Effect& of = kEffects[i];
      if (!(of.*doubted)) continue;
      largest = std::max(largest, s);
      if (s < 1.0) continue;
      HealthState now = HealthState::kDegraded;
      if (reason == HealthReason::kRadarSilent) now = HealthState::kDeadReckoning;
      if (of.loses && s >= kHealthLost) now = HealthState::kLost;
      state = std::max(state, now);
    }
    return begun_ ? state : HealthState::kInitializing;
  };
  health_.position = worst(&Effect::position);
  health_.velocity = worst(&Effect::velocity);
  health_.heading = worst(&Effect::heading);
  health_.state = std::max({health_.position, health_.velocity, health_.heading});
  health_.quality = static_cast<int>(std::lround(100.0 / (1.0 + largest * largest)));
}

}  // namespace rio

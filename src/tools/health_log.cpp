// SPDX-License-Identifier: BSD-3-Clause
#include "health_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "rio/checks/stamp_guard.hpp"
#include "view/calibration_names.hpp"

namespace rio::tools {

namespace {

void append(std::string* list, const std::string& item) {
  if (!list->empty()) *list += "; ";
  *list += item;
}

HealthReason reason_at(std::size_t i) {
  return static_cast<HealthReason>(i);
}

}  // namespace

std::vector<CalibrationLine> calibration_lines(const Calibrations& calibration) {
  std::vector<CalibrationLine> lines;
  for (std::size_t r = 0; r < calibration.size(); ++r) {
    for (std::size_t i = 0; i < kCalibrationCount; ++i) {
      const CalibrationReport& report = calibration[r][i];
      const Observability verdict = report.observability;
      if (verdict == Observability::kNotEstimated) continue;
      const bool doubtful =
          verdict == Observability::kDoubtful || verdict == Observability::kAtLimit;
      lines.push_back({view::calibration_name(i, r), view::kCalibrationNames[i].unit,
                       view::kCalibrationNames[i].scale, report,
                       doubtful ? view::calibration_check(i, r) : ""});
    }
  }
  return lines;
}

void HealthLog::add(Time time, const Health& health) {
  constexpr Time kJump = std::chrono::hours(1);  // of the clock
  if (!is_stamp(time)) return;
  if (!last_) begin_ = time;
  const Time step = time - last_.value_or(time);
  const bool jumps = step > kJump || -step > kJump;
  if (jumps) begin_ += step;
  const double seconds = jumps ? 0.0 : std::max(0.0, to_seconds(step));
  last_ = time;
  health_ = health;
  seconds_[static_cast<std::size_t>(health.state)] += seconds;
  if (health.state == HealthState::kInitializing) return;
  for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
    Reason& reason = reasons_[i];
    reason.severity = std::max(reason.severity, health.severity[i]);
    if (!health.because(reason_at(i))) continue;
    if (reason.seconds == 0.0) reason.first = time;
    reason.seconds += seconds;
  }
}

void HealthLog::conclude(const Calibrations& calibration, bool too_fast, double used,
                         const std::string& doubt) {
  used_ = used;
  doubts_ = doubt;
  for (const CalibrationLine& line : calibration_lines(calibration)) {
    if (line.check.empty()) continue;
    append(&doubts_, fmt::format("{} is {}, check {}", line.name,
                                 to_string(line.report.observability), line.check));
  }
  lost_because_.clear();
  if (too_fast) append(&lost_because_, "faster or farther than anything that carries a radar");
  if (health_.state != HealthState::kLost) return;
  for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
    if (health_.because(reason_at(i))) append(&lost_because_, to_string(reason_at(i)));
  }
}

std::string HealthLog::verdict() const {
  if (lost()) return "lost: " + lost_because_;
  std::string why;
  if (health_.state == HealthState::kInitializing)
    append(&why, "no scan was used since the start or the last restart");
  if (used_ < 0.5) append(&why, fmt::format("only {:.0f} % of the scans were used", 100.0 * used_));
  for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
    const Reason& reason = reasons_[i];
    if (reason.seconds == 0.0) continue;
    append(&why, fmt::format("{} for {:.{}f} s, first at {:.1f} s", to_string(reason_at(i)),
                             reason.seconds, reason.seconds < 0.1 ? 3 : 1,
                             to_seconds(reason.first - begin_)));
  }
  if (!doubts_.empty()) append(&why, doubts_);
  return why.empty() ? "healthy" : "doubtful: " + why;
}

nlohmann::ordered_json HealthLog::json() const {
  nlohmann::ordered_json states;
  for (std::size_t i = 0; i < kStates; ++i) {
    states[to_string(static_cast<HealthState>(i))] = seconds_[i];
  }
  nlohmann::ordered_json reasons = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
    const Reason& reason = reasons_[i];
    if (reason.seconds == 0.0) continue;
    reasons[to_string(reason_at(i))] = {{"seconds", reason.seconds},
                                        {"first_s", to_seconds(reason.first - begin_)},
                                        {"severity", reason.severity}};
  }
  return {{"state", to_string(health_.state)},
          {"position", to_string(health_.position)},
          {"velocity", to_string(health_.velocity)},
          {"heading", to_string(health_.heading)},
          {"quality", health_.quality},
          {"reset_counter", health_.reset_counter},
          {"seconds", states},
          {"reasons", reasons}};
}

}  // namespace rio::tools

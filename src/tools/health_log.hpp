// SPDX-License-Identifier: BSD-3-Clause
// The health of the estimate over a replay, and the verdict that follows from it.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rio/health.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio::tools {

/// By radar.
using Calibrations = std::vector<std::array<CalibrationReport, kCalibrationCount>>;

/// An estimated parameter of the calibration, for display.
struct CalibrationLine {
  std::string name;  ///< "radar1_time_offset"
  const char* unit;
  double scale;  ///< from SI to it
  CalibrationReport report;
  std::string check;  ///< possible cause if it is doubtful or at its limit, else empty
};
std::vector<CalibrationLine> calibration_lines(const Calibrations& calibration);

class HealthLog {
 public:
  /// The health at `time`, valid until the next call.
  void add(Time time, const Health& health);

  /// Calibration at the end: doubtful parameters make the verdict doubtful.
  /// @param doubt the same of anything else; empty: none
  /// @param too_fast the path is beyond that of any vehicle
  /// @param used share of the scans of the recording
  void conclude(const Calibrations& calibration, bool too_fast, double used = 1.0,
                const std::string& doubt = {});

  bool lost() const { return !lost_because_.empty(); }
  /// Why the estimate is lost; empty if it is not.
  const std::string& lost_because() const { return lost_because_; }
  /// "healthy", "doubtful: why" or "lost: why".
  std::string verdict() const;
  nlohmann::ordered_json json() const;

 private:
  struct Reason {
    double seconds = 0.0;  ///< total duration of the reason
    Time first{0};
    double severity = 0.0;  ///< the largest
  };

  static constexpr std::size_t kStates = 5;

  Time begin_{0};
  std::optional<Time> last_;
  Health health_;
  std::array<double, kStates> seconds_{};  ///< in each state
  std::array<Reason, kHealthReasonCount> reasons_{};
  double used_ = 1.0;   ///< share of the scans
  std::string doubts_;  ///< and the doubtful parameters of the calibration
  std::string lost_because_;
};

}  // namespace rio::tools

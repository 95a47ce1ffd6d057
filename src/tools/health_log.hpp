// SPDX-License-Identifier: BSD-3-Clause
// The health of the estimate over a replay, and the verdict that follows from it.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "rio/health.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio::tools {

class HealthLog {
 public:
  /// The health at `time`, valid until the next call.
  void add(Time time, const Health& health);

  /// Calibration at the end: doubtful parameters make the verdict doubtful.
  /// @param too_fast the path is beyond that of any vehicle
  /// @param calibration by radar
  /// @param used share of the scans of the recording
  void conclude(const std::vector<std::array<CalibrationReport, kCalibrationCount>>& calibration,
                bool too_fast, double used = 1.0);

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
  Time last_{0};
  bool has_last_ = false;
  Health health_;
  std::array<double, kStates> seconds_{};  ///< in each state
  std::array<Reason, kHealthReasonCount> reasons_{};
  double used_ = 1.0;        ///< share of the scans
  std::string calibration_;  ///< names of its doubtful parameters
  std::string lost_because_;
};

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// Statistics of a replay over its scans, and their output.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "check/finding.hpp"
#include "health_log.hpp"
#include "rio/aiding.hpp"
#include "rio/models/aids.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio::tools {

/// How the estimator has started by itself: "static" or "in motion" (start.max_wait).
std::string start_name(const Counters& counters);

struct ReplaySummary {
  bool started = true;  ///< the estimator
  /// "groundtruth", "file" or start_name(); of rio live also why it never started
  std::string initialised_by;
  int scans = 0;    ///< processed
  int updates = 0;  ///< of these, with at least one row used
  int scans_before_start = 0;
  int scans_unprocessed = 0;  ///< after the last IMU sample
  std::vector<double> update_ms;
  std::vector<double> propagation_ms;
  std::array<ModelReport, kModelCount> models{};
  Calibrations calibration;  ///< last
  int clones = 0;            ///< at the end
  int landmarks = 0;         ///< at the end
  Vector3d first_position = Vector3d::Zero();
  Vector3d last_position = Vector3d::Zero();
  Vector3d position_before = Vector3d::Zero();  ///< at the last scan of an earlier time
  Time last_time{0};
  double path_length = 0.0;    ///< through the times of scans [m]
  double length_before = 0.0;  ///< of the path to position_before [m]
  double fastest = 0.0;        ///< largest speed [m/s]
  double farthest = 0.0;       ///< largest distance from the first position [m]
  Time span{0};                ///< of the data fed
  Time wall{0};                ///< spent in the estimator
  Counters counters;
  std::string without_scans;  ///< of rio live: each radar without usable scans, or few, and why
  std::optional<AuxiliaryEstimate<HeightOffset>> height_offset;  ///< with a barometer, at the end
  HealthLog health;
  std::optional<check::Findings> data;  ///< of `rio check`, not ok; empty if not requested

  std::optional<double> checked_seconds;  ///< if that is not all of the recording [s]

  void add(const UpdateReport& report, const NavState& state);

  /// Faster than sound, or farther away than sound would be.
  bool is_absurd() const;

  /// Mean NIS of a height of the barometer.
  double height_nis() const;

  /// One line of JSON.
  std::string json() const;
  /// Some lines of text.
  std::string text() const;
};

}  // namespace rio::tools

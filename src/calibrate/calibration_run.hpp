// SPDX-License-Identifier: BSD-3-Clause
// A recording, or a part of it, through the estimator as it flies, and what its calibration is at
// the end.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "calibrate/noise_calibration.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio::calibrate {

using CalibrationReports = std::array<CalibrationReport, kCalibrationCount>;

/// What a run ends with.
struct CalibrationRun {
  CalibrationReports calibration;  ///< after the last scan, off the values of the options
  std::vector<Start> states;       ///< after each scan
  int velocity_resets = 0;         ///< times the scans contradicted the velocity
};

/// Runs `recording` up to `end`.
/// @param start static alignment without one; data before it is left out
/// @throws std::runtime_error if the options are invalid, the run does not start or sees no scan
CalibrationRun run_calibration(const Recording& recording, const Options& options,
                               const std::optional<Start>& start,
                               Time end = Time(std::numeric_limits<Time::rep>::max()));

/// The first state from which the way still to go is not longer than the way come; the way is that
/// of the velocity, so that standing at either end counts for neither half.
const Start& half_way(const std::vector<Start>& states);

}  // namespace rio::calibrate

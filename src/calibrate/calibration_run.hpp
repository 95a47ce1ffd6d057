// SPDX-License-Identifier: BSD-3-Clause
// Runs a recording, or a part of it, through the estimator as in flight, and returns the
// calibration at the end.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibrate/noise_calibration.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio::calibrate {

using CalibrationReports = std::array<CalibrationReport, kCalibrationCount>;

/// Result of a run.
struct CalibrationRun {
  CalibrationReports calibration;  ///< after the last scan, relative to the values of the options
  std::vector<Start> states;       ///< after each scan
  bool began_in_motion = false;    ///< without a standstill
  int velocity_resets = 0;         ///< number of resets because the scans contradicted the velocity
};

inline constexpr Time kToTheEnd = Time::max();

/// Runs `recording` up to `end`.
/// @param start if missing, static alignment; earlier data are skipped
/// @throws std::runtime_error if the options are invalid, the run does not start or processes no
/// scan
CalibrationRun run_calibration(const Recording& recording, const Options& options,
                               const std::optional<Start>& start, Time end = kToTheEnd);

/// The first state with at least half of the distance behind it. The distance is the integral of
/// the speed, so standing at either end counts for neither half.
const Start& half_way(const std::vector<Start>& states);

/// Variance of the rotation of a radar that its errors of direction cause along each of its axes,
/// the larger the less the motion shows of it: (E8) of radar_calibration.hpp [rad^2].
/// @param q_SB from body axes to those of the radar
Vector3d unshown_turn(const std::vector<Start>& states, const Quaternion& q_SB);

}  // namespace rio::calibrate

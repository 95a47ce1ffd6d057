// SPDX-License-Identifier: BSD-3-Clause
// Observability of the calibration: for each parameter the estimate, its sigma compared with the
// prior's, and how well the data determine it.
//
// A parameter that no motion excites keeps the sigma of its prior (Observability in report.hpp).
// The sigma of the covariance rises with the random walk of the parameter, and when the configured
// value is contradicted (state_estimate.hpp); it is reported multiplied by the Birge ratio.
#pragma once

#include <array>

#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/update/birge_ratio.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

/// @param value estimate minus configured value; all in the unit of the parameter
Observability observability(double value, double sigma, double prior_sigma);

/// Of one radar, indexed by Calibration.
using BirgeRatios = std::array<BirgeRatio, kCalibrationCount>;

/// For the radar whose scan is being processed, indexed by Calibration.
/// @param ratios of this radar; the estimates are added
std::array<CalibrationReport, kCalibrationCount> calibration_report(
    const StateEstimate& state_estimate, const Options& options, BirgeRatios* ratios);

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Observability of the calibration: for each parameter the estimate, its sigma compared with the
// prior's, and how well the data determine it.
//
// A parameter that no motion excites keeps the sigma of its prior (Observability in report.hpp).
// The sigma rises with the random walk of the parameter.
#pragma once

#include <array>

#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

/// @param value estimate minus configured value; all in the unit of the parameter
Observability observability(double value, double sigma, double prior_sigma);

/// For the radar whose scan is being processed, indexed by Calibration.
std::array<CalibrationReport, kCalibrationCount> calibration_report(
    const StateEstimate& state_estimate, const Options& options);

}  // namespace rio

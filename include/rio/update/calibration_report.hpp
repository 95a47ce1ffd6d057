// SPDX-License-Identifier: BSD-3-Clause
// What the flight has told about each parameter of the calibration: the estimate, its sigma against
// the prior's, and how far the data tell it.
//
// A parameter that no motion excites keeps the sigma of its prior (Observability in report.hpp). A
// constant cannot become less known, so the sigma never rises again.
#pragma once

#include <array>

#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

Observability observability(double value, double sigma, double prior_sigma);

std::array<CalibrationReport, kCalibrationCount> calibration_report(
    const StateEstimate& state_estimate, const Options& options);

}  // namespace rio

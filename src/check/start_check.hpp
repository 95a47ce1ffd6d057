// SPDX-License-Identifier: BSD-3-Clause
// Whether the estimator finds the standstill with which it starts, and what a late one costs.
#pragma once

#include <vector>

#include "check/finding.hpp"
#include "check/scans.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// Subject "start".
/// @param samples usable(), in SI units after the factors
/// @param scans of the first radar
Finding check_start(const std::vector<ImuSample>& samples, double gyro_unit, double accel_unit,
                    const Scans& scans, const Options& options);

}  // namespace rio::check

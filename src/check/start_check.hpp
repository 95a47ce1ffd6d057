// SPDX-License-Identifier: BSD-3-Clause
// Whether the estimator finds the standstill with which it starts, and what a late one costs.
#pragma once

#include "check/finding.hpp"
#include "check/imu_check.hpp"
#include "check/scans.hpp"
#include "rio/options.hpp"

namespace rio::check {

/// Subject "start".
/// @param scans of the first radar
Finding check_start(const CheckedImu& imu, const Scans& scans, const Options& options);

}  // namespace rio::check

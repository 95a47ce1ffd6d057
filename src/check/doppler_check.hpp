// SPDX-License-Identifier: BSD-3-Clause
// The Doppler of a radar: its columns, its limit, and whether it is zero at rest.
#pragma once

#include "check/advice.hpp"
#include "check/imu_check.hpp"
#include "check/scans.hpp"
#include "rio/options.hpp"

namespace rio::check {

Finding check_doppler(const Scans& scans, const CheckedImu& imu, const Options& options,
                      const Advice& advice);

/// The largest Doppler except for one of a thousand [m/s]: where a radar folds whose limit is
/// configured in another unit.
double fastest(const Scans& scans);

}  // namespace rio::check

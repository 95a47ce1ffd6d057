// SPDX-License-Identifier: BSD-3-Clause
// The gyro by the radar: both agree only with rates in another unit, of another range, of
// another sign, or in other axes than the accelerometer.
#pragma once

#include <optional>

#include "check/judge.hpp"

namespace rio::check {

/// @param as_read explained with the rates as they are
std::optional<Finding> check_gyro_by_radar(const Judge& judge, double as_read);

}  // namespace rio::check

// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as the calibration takes recordings.
#pragma once

#include <optional>

#include "calibrate/noise_calibration.hpp"
#include "rio/sim/flight.hpp"

namespace rio::test {

/// The samples and scans of the flight; no start, no truth.
inline calibrate::Recording recording_of(const sim::Flight& flight) {
  return {flight.imu, flight.scans, std::nullopt, {}};
}

}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
// Steps of the clock of a radar within a recording: a clock that is set, a driver that starts
// again. An interval between stamps that is not the usual one is a pause of the radar or a step of
// its clock. A step, if with all later stamps moved back by it the motion of radar and IMU agrees
// significantly better after it, by (E6) of motion.hpp, than with the stamps as they are.
#pragma once

#include <cstddef>
#include <vector>

#include "check/check.hpp"
#include "check/imu_check.hpp"
#include "check/scans.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// A step of a clock between two scans.
struct ClockStep {
  std::size_t scan = 0;  ///< the first after it
  Time size{0};          ///< by which all later stamps are off
};

/// The intervals that may be steps, each as if it were one, in the order of time. Stamps alone
/// tell: without any of them no data need be read.
/// @param stamps of one radar, in the order of the recording
std::vector<ClockStep> possible_steps(const std::vector<Time>& stamps);

/// Those that the motion shows.
/// @param options with the mounting of the radar as that of the first one
std::vector<ClockStep> clock_steps(const CheckedImu& imu, const Scans& scans,
                                   const Options& options);
/// @param options with the sensor properties of the recording
std::vector<ClockStep> clock_steps(const CheckedData& data, const Options& options,
                                   std::size_t radar);

/// By how much the stamp of a scan is off.
Time offset_at(const std::vector<ClockStep>& steps, std::size_t scan);

/// With the steps taken out of the stamps.
Scans without_steps(const Scans& scans, const std::vector<ClockStep>& steps);

}  // namespace rio::check

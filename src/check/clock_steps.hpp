// SPDX-License-Identifier: BSD-3-Clause
// Steps of the clock of one sensor within a recording: a clock that is set, a driver that starts
// again. An interval between stamps that is not the usual one is a pause of the sensor or a step of
// its clock. A step, if with all later stamps moved back by it the motion of radar and IMU agrees
// significantly better, by (E6) of motion.hpp, than with the stamps as they are. Stamps that go
// back and stay there are always a step. Where both clocks go forward together nothing tells a step
// from a pause.
#pragma once

#include <cstddef>
#include <vector>

#include "check/scans.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// A step of a clock between two scans or samples.
struct ClockStep {
  std::size_t first = 0;  ///< the first after it
  Time size{0};           ///< by which all later stamps are off
  /// The stamps go back, and stay there: no pause, no corrupt stamp, no items out of order.
  bool certain = false;
};

/// The intervals that may be steps, each as if it were one, in the order of time. Stamps alone
/// tell: without any of them no data need be read.
/// @param stamps of one sensor, in the order of the recording
std::vector<ClockStep> possible_steps(const std::vector<Time>& stamps);

/// Those of all sensors that the motion shows: of the IMU by the first radar, then of each radar.
struct ClockSteps {
  std::vector<ClockStep> imu;
  std::vector<std::vector<ClockStep>> radars;
};
/// @param options with the sensor properties of the recording
ClockSteps find_clock_steps(const std::vector<ImuSample>& samples, const std::vector<Scans>& radars,
                            const io::ImuInfo& info, const Options& options);

/// The stamp of a scan or sample without the steps before it; one that is none stays.
Time without_steps(Time stamp, const std::vector<ClockStep>& steps, std::size_t item);
/// All of them.
Scans without_steps(const Scans& scans, const std::vector<ClockStep>& steps);
std::vector<ImuSample> without_steps(std::vector<ImuSample> samples,
                                     const std::vector<ClockStep>& steps);

}  // namespace rio::check

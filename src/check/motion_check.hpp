// SPDX-License-Identifier: BSD-3-Clause
// Checks from the motion: the axes and the sign with which the radar velocities fit the IMU, the
// scale of the Doppler, the delay of the stamps. Reports if the motion gives no information.
//
// Axes: the configured mounting competes with all others by right angles, about axes of the radar
// or of the body, each with both signs of the Doppler, and with the best at any angle if none of
// these is near it, all at the best delay. The configuration is wrong only if another hypothesis
// explains the movement, the configured one is clearly worse, and the difference is significant by
// (E6) of motion.hpp.
#pragma once

#include <cstddef>
#include <vector>

#include "check/finding.hpp"
#include "check/motion.hpp"
#include "rio/options.hpp"

namespace rio::check {

/// @param samples usable(), @param gyro_unit, accel_unit found by check_imu()
/// @param radar its number; the options have its mounting as that of the first radar
Findings check_motion(const std::vector<ImuSample>& samples, const std::vector<RadarSpeed>& speeds,
                      double gyro_unit, double accel_unit, const Options& options, Source source,
                      std::size_t radar);

}  // namespace rio::check

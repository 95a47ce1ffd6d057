// SPDX-License-Identifier: BSD-3-Clause
// From the motion: the axes and the sign the radar's velocities fit the IMU with, the scale of the
// Doppler, the delay of the stamps. Where the motion does not tell, it says so.
//
// Axes: the told mounting against all others by right angles, about axes of the radar or of the
// body, each with both signs of the Doppler, and against the best at any angle where none of these
// is near it, all at the delay that fits best. Something else is wrong only if it explains the
// movement, the told one explains it clearly worse, and by (E6) of motion.hpp that is no chance.
#pragma once

#include <cstddef>
#include <vector>

#include "check/finding.hpp"
#include "check/motion.hpp"
#include "rio/options.hpp"

namespace rio::check {

/// @param samples usable(), @param gyro_unit, accel_unit found by check_imu()
/// @param radar its number; the options have its mounting as that of the first one
Findings check_motion(const std::vector<ImuSample>& samples, const std::vector<RadarSpeed>& speeds,
                      double gyro_unit, double accel_unit, const Options& options, Source source,
                      std::size_t radar);

}  // namespace rio::check

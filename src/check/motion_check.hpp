// SPDX-License-Identifier: BSD-3-Clause
// Checks from the motion: the axes and the sign with which the radar velocities fit the IMU, the
// scale of the Doppler, the delay of the stamps. Reports if the motion gives no information.
//
// An unknown mounting is not judged: the rotation that the motion shows takes its place. Rates of
// another sign, order or range (gyro_check.hpp) come first. A radar that hardly moves, or by far
// less than the IMU, has a Doppler from which the motion of the vehicle was subtracted.
//
// Windows of two seconds hardly notice the biases of the IMU. If no candidate explains the movement
// in them, as with a few points a scan on a slow vehicle, longer ones are tried: noise and
// vibration matter less the more the velocity changes. Delays of seconds are tried if nothing
// explains the movement, or the longest of the usual delays does best.
#pragma once

#include <cstddef>

#include "check/advice.hpp"
#include "check/motion_data.hpp"
#include "rio/options.hpp"

namespace rio::check {

/// @param options with the mounting of the radar as that of the first one
Findings check_motion(const MotionData& data, const Options& options, const Advice& advice);

}  // namespace rio::check

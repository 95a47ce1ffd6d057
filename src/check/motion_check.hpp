// SPDX-License-Identifier: BSD-3-Clause
// Checks from the motion: the axes and the sign with which the radar velocities fit the IMU, the
// scale of the Doppler, the delay of the stamps. Reports if the motion gives no information.
//
// An unknown mounting is not judged: the rotation that the motion shows takes its place. Rates of
// another sign, order or range (judge.hpp) come first. A radar that hardly moves, or by far
// less than the IMU, has a Doppler from which the motion of the vehicle was subtracted.
//
// Windows of two seconds hardly notice the biases of the IMU. If no candidate explains the movement
// in them, as with a few points a scan on a slow vehicle, longer ones are tried: noise and
// vibration matter less the more the velocity changes. Delays of seconds are tried if nothing
// explains the movement, or the longest of the usual delays does best.
#pragma once

#include <cstddef>
#include <vector>

#include "check/advice.hpp"
#include "check/axes.hpp"
#include "check/motion.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

inline constexpr double kSignificant = 3.0;  ///< sigmas, of (E6) of motion.hpp
inline constexpr double kExplained = 0.5;    ///< of the movement: not reached by chance
inline constexpr std::size_t kFewestWindows = 3;

/// The data, and what other checks found in them.
struct MotionData {
  const std::vector<ImuSample>& samples;  ///< CheckedImu::good
  const std::vector<RadarSpeed>& speeds;
  double gyro_unit = 1.0;                            ///< of check_imu() or check_rates()
  double accel_unit = 1.0;                           ///< of check_imu()
  DopplerSign doppler_sign = DopplerSign::kUnknown;  ///< of check_ranges()
  Vector3d up = Vector3d::Zero();                    ///< Rest::accel
  double scale_error = 1.25;  ///< factor by which a Doppler scale may be off and is right
};

/// @param options with the mounting of the radar as that of the first one
Findings check_motion(const MotionData& data, const Options& options, const Advice& advice);

}  // namespace rio::check

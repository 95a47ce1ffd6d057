// SPDX-License-Identifier: BSD-3-Clause
// What the checks from the motion have in common (motion_check.hpp, delay_check.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "check/motion.hpp"
#include "check/points_check.hpp"
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

}  // namespace rio::check

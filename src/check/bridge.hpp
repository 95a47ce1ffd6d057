// SPDX-License-Identifier: BSD-3-Clause
// How long the IMU stands in for what is missing: the rules by which gaps are judged.
#pragma once

namespace rio::check {

/// What velocity and tilt are uncertain by at most while an estimate is ok; the limits of
/// HealthReason::kUncertainVelocity and kUncertainTilt.
inline constexpr double kMostVelocity = 0.5;                               // [m/s]
inline constexpr double kMostTilt = 3.0 * 3.14159265358979323846 / 180.0;  // [rad]

/// The tilt in flight is known to about a degree, and feigns this acceleration.
inline constexpr double kFeigned = 0.17;  // [m/s^2]

/// The radar may be silent as long before the velocity is uncertain.
inline constexpr double kLongestSilence = kMostVelocity / kFeigned;  // [s]

/// From one velocity of the radar to the next the IMU adds less than the error of the first.
inline constexpr double kSparseVelocities = 0.1 / kFeigned;  // [s]

}  // namespace rio::check

// SPDX-License-Identifier: BSD-3-Clause
// How long the IMU can bridge missing data: the rules by which gaps are judged.
#pragma once

namespace rio::check {

/// Largest uncertainty of velocity and tilt of an estimate that is ok; the limits of
/// HealthReason::kUncertainVelocity and kUncertainTilt.
inline constexpr double kMostVelocity = 0.5;                               // [m/s]
inline constexpr double kMostTilt = 3.0 * 3.14159265358979323846 / 180.0;  // [rad]

/// The tilt in flight is known to about a degree, which causes this apparent acceleration.
inline constexpr double kFeigned = 0.17;  // [m/s^2]

/// A longer silence of the radar makes the velocity uncertain.
inline constexpr double kLongestSilence = kMostVelocity / kFeigned;  // [s]

/// Up to this interval of radar velocities the IMU adds less than the error of one of them.
inline constexpr double kSparseVelocities = 0.1 / kFeigned;  // [s]

}  // namespace rio::check

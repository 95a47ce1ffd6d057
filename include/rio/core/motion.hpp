// SPDX-License-Identifier: BSD-3-Clause
// How fast a small robot and what moves beside it are: figures that several rooms share.
#pragma once

namespace rio {

inline constexpr double kFastestRobot = 30.0;        ///< none is faster [m/s]
inline constexpr double kVelocityChange = 2.0;       ///< of one in 1 to 2 s, sigma an axis [m/s]
inline constexpr double kStandstillVelocity = 0.01;  ///< of a body at rest, sigma an axis [m/s]
inline constexpr double kPaceOfPeople = 1.0;         ///< [m/s]
/// Rows of one reflector within a window repeat their error: the variance of a velocity or force
/// fitted to them is larger by this factor than that of as many independent rows.
inline constexpr double kRepetitionInWindow = 4.0;

}  // namespace rio

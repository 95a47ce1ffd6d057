// SPDX-License-Identifier: BSD-3-Clause
// The axes and the sign of the Doppler with which the velocities of the radar fit the IMU.
//
// The configured mounting competes with all others by right angles, about axes of the radar
// or of the body, each with both signs of the Doppler, and with the best at any angle if none of
// these is near it, all at the best delay. The configuration is wrong only if another hypothesis
// explains the movement, the configured one is clearly worse, and the difference is significant by
// (E6) of motion.hpp. What the ranges say of the sign (points_check.hpp) excludes candidates:
// motion in a plane does not distinguish the other sign from a radar turned by 180 deg.
#pragma once

#include <string>
#include <vector>

#include "check/axes.hpp"
#include "check/judge.hpp"

namespace rio::check {

/// The rotation with which b^T r of (E4) is largest (Wahba's problem).
/// @param sign -1: the mirrored one, as if the Doppler were flipped
Matrix3d best_rotation(const Agreement& all, double sign = 1.0);

/// The best of the candidates; the first of those that it does not beat significantly.
/// @param alike all of these, first the one that is returned
Axes choose_axes(const Judge& judge, std::vector<Axes>* alike);

/// @param found,alike of choose_axes()
Finding check_axes(const Judge& judge, const Axes& found, const std::vector<Axes>& alike);

/// The Doppler lacks the motion of the vehicle, as `text` says, unless the IMU measures nonsense.
Finding compensated(const Judge& judge, const std::string& text);

}  // namespace rio::check

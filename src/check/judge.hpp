// SPDX-License-Identifier: BSD-3-Clause
// The parts of the check from the motion: what they judge, and the axes and the gyro.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "check/motion_check.hpp"

namespace rio::check {

inline constexpr double kShortestWindow = 2.0;  ///< hardly notices the biases of the IMU [s]

/// The windows of one length.
struct Judge {
  const MotionData& data;
  const Agreement& all;  ///< of the windows
  double length;         ///< of a window [s]
  const Options& options;
  const Advice& advice;
  Matrix3d configured = options.radar.T_BS.rotation.toRotationMatrix();

  double doubt(const Matrix3d& worse, const Matrix3d& better) const {
    return significance(all.explained(worse), all.explained(better), all.windows);
  }
};

// The axes and the sign of the Doppler with which the velocities of the radar fit the IMU.
//
// The configured mounting competes with all others by right angles, about axes of the radar
// or of the body, each with both signs of the Doppler, and with the best at any angle if none of
// these is near it, all at the best delay. The configuration is wrong only if another hypothesis
// explains the movement, the configured one is clearly worse, and the difference is significant by
// (E6) of motion.hpp. What the ranges say of the sign (points_check.hpp) excludes candidates:
// motion in a plane does not distinguish the other sign from a radar turned by 180 deg.

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

// The gyro by the radar: both agree only with rates in another unit, of another range, of another
// sign, or in other axes than the accelerometer.

/// @param as_read explained with the rates as they are
std::optional<Finding> check_gyro_by_radar(const Judge& judge, double as_read);

}  // namespace rio::check

// SPDX-License-Identifier: BSD-3-Clause
// Checks from the motion: the axes and the sign with which the radar velocities fit the IMU, the
// scale of the Doppler, the delay of the stamps. Reports if the motion gives no information.
//
// An unknown mounting is not judged: the rotation that the motion shows takes its place. Rates of
// another sign, order or range come first. A radar that hardly moves, or by far less than the IMU,
// has a Doppler from which the motion of the vehicle was subtracted.
//
// Windows of two seconds hardly notice the biases of the IMU. If no candidate explains the movement
// in them, as with a few points a scan on a slow vehicle, longer ones are tried: noise and
// vibration matter less the more the velocity changes. Delays of seconds are tried if nothing
// explains the movement, or the longest of the usual delays does best.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "check/advice.hpp"
#include "check/axes.hpp"
#include "check/imu_check.hpp"
#include "check/motion.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

inline constexpr double kSignificant = 3.0;  ///< sigmas, of (E6) of motion.hpp
inline constexpr double kExplained = 0.5;    ///< of the movement: not reached by chance
inline constexpr std::size_t kFewestWindows = 3;

/// The data, and what other checks found in them.
struct MotionData {
  const CheckedImu& imu;
  const std::vector<RadarSpeed>& speeds;
  double gyro_unit;          ///< of check_imu() or check_rates()
  DopplerSign doppler_sign;  ///< of check_ranges()
  double scale_error;        ///< factor by which a Doppler scale may be off and is right

  /// @param factor of the rates
  ImuPath path(const Matrix3d& factor = Matrix3d::Identity()) const {
    return {imu.good, gyro_unit * factor, imu.check.accel_unit};
  }
};

/// @param options with the mounting of the radar as that of the first one
Findings check_motion(const MotionData& data, const Options& options, const Advice& advice);

// Its parts: the windows that are judged, their axes, and the gyro.

/// The best of the candidates() in some windows.
struct BestAxes {
  Axes axes;
  double explained = 0.0;   ///< (E4) of motion.hpp
  std::size_t windows = 0;  ///< their number

  /// In sigmas.
  double better_than(double other) const { return significance(other, explained, windows); }
};
/// @param sign of the Doppler, which may exclude some
BestAxes best_axes(const Agreement& windows, const Options& options, DopplerSign sign);

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
/// @param strongest direction in radar axes along which the motion is largest: the turn about it is
///        the least sure
Matrix3d best_rotation(const Agreement& all, double sign = 1.0, Vector3d* strongest = nullptr);

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

/// The factor of the rates with which a Doppler that seems to have another scale has the right one
/// and the radar with the axes R explains the movement, too. Of plane turns alone: their
/// specific force is v w, whichever of the two is wrong.
std::optional<double> other_range(const Judge& judge, const Matrix3d& R);

}  // namespace rio::check

// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: re-initialises the state after the tilt was lost: in a pause of the IMU in which the
// body may have rotated by any angle, or because the estimate diverged. A linearised update cannot
// recover from that. The start in motion (moving_start.hpp) finds the tilt in a second and a half,
// the first scans after it the velocity. The position is kept and the heading integrated from the
// gyroscope; the covariance of the position is inflated by the distance possibly travelled.
#pragma once

#include <optional>

#include "rio/options.hpp"
#include "rio/propagate/moving_start.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/types.hpp"

namespace rio {

class Restart {
 public:
  /// @param gravity [m/s^2]
  Restart(const StartOptions& start, double gravity);

  bool active() const { return active_; }
  void reset() { active_ = false; }

  /// The tilt is lost: starts from the estimate x.
  /// @param P covariance of x, order of namespace body
  /// @param diverged heading and position may be wrong beyond their sigmas
  void begin(const NavState& x, const BodyCovariance& P, bool diverged);

  /// The new state once it is known; to be called with every sample while active.
  /// @param pause the IMU paused before this sample: the mean of the specific force starts over
  std::optional<Alignment> add(const ImuSample& sample, bool pause);

 private:
  static constexpr double kDuration = 1.5;   // of the mean, as a static alignment [s]
  static constexpr double kSpeed = 1.0;      // possibly gained meanwhile [m/s]
  static constexpr double kAnyYaw = 1.8;     // sigma of an unknown heading [rad]
  static constexpr double kUnnoticed = 2.0;  // delay until divergence is detected [s]
  static constexpr double kNoGravity = 0.5;  // relative deviation of the mean force from g

  double gravity_;
  MovingStart tilt_;
  bool active_ = false;
  NavState before_;
  Time newest_{0};
  double sigma_position_ = 0.0;  ///< when the tilt was lost [m]
  double sigma_yaw_ = 0.0;       ///< same [rad]
};

}  // namespace rio

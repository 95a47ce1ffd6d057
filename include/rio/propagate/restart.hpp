// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: the state after the tilt was lost, in a pause of the IMU in which the body may have
// turned anyhow, or because the estimate has run away. No linearisation carries that; the start in
// motion (moving_start.hpp) finds the tilt again in a second and a half, and the first scans after
// it the velocity. Position and heading stay as they were, with what they may have changed since.
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

  /// The tilt is lost.
  /// @param P covariance of the estimate x, order of namespace body
  /// @param diverged heading and position may be wrong beyond their sigmas
  void begin(const NavState& x, const BodyCovariance& P, bool diverged);

  /// The state once it is known; asked for while active.
  /// @param pause the IMU told nothing before this sample: the specific force is summed up anew
  std::optional<Alignment> add(const ImuSample& sample, bool pause);

 private:
  static constexpr double kDuration = 1.5;   // as a static alignment takes [s]
  static constexpr double kSpeed = 1.0;      // gained meanwhile [m/s]
  static constexpr double kAnyYaw = 1.8;     // sigma of a heading that may be any [rad]
  static constexpr double kUnnoticed = 2.0;  // an estimate has run away before that is clear [s]
  static constexpr double kNoGravity = 0.5;  // share of g that the mean specific force is off

  double gravity_;
  MovingStart tilt_;
  bool active_ = false;
  NavState before_;
  Time newest_{0};
  double sigma_position_ = 0.0;  ///< when it was lost [m]
  double sigma_yaw_ = 0.0;       ///< same [rad]
};

}  // namespace rio

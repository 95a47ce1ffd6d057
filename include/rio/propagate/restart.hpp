// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: re-initialises the state after the tilt was lost: in a pause of the IMU in which the
// body may have rotated by any angle, or because the estimate diverged. A linearised update cannot
// recover from that. The start in motion (moving_start.hpp) finds the tilt in a second and a half,
// the first scans after it the velocity. The position is kept, after a pause that before it: what
// was extrapolated through the pause tells less. The heading is integrated from the gyroscope. The
// covariance is inflated by the distance possibly travelled and the unknown rotation in the pause.
#pragma once

#include <optional>

#include "rio/options.hpp"
#include "rio/propagate/moving_start.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/types.hpp"

namespace rio {

class Restart {
 public:
  Restart(const StartOptions& start, const ImuOptions& imu);

  bool active() const { return active_; }
  void reset() {
    active_ = false;
    before_pause_.reset();
  }

  /// The IMU has paused until `end`, and the estimate has not yet reached the pause.
  /// @param P covariance of the estimate x, order of namespace body
  void pause(const NavState& x, const BodyCovariance& P, Time end) {
    if (!before_pause_) before_pause_ = estimate(x, P);
    resumed_ = end;
  }
  /// The estimate has reached `time`, and its tilt is known.
  void passed(Time time) {
    if (time >= resumed_) before_pause_.reset();
  }

  /// The tilt is lost: starts from the estimate x, or from that before the pause.
  /// @param P covariance of x, order of namespace body
  /// @param diverged heading and position may be wrong beyond their sigmas
  /// @param now time of the newest sample
  void begin(const NavState& x, const BodyCovariance& P, bool diverged, Time now);

  /// The new state once it is known; to be called with every sample while active.
  /// @param pause the IMU paused before this sample: the mean of the specific force starts over
  std::optional<Alignment> add(const ImuSample& sample, bool pause);

 private:
  static constexpr double kDuration = 1.5;        // of the mean, as a static alignment [s]
  static constexpr double kSpeed = 1.0;           // possibly gained meanwhile [m/s]
  static constexpr double kAnyYaw = 1.8;          // sigma of an unknown heading [rad]
  static constexpr double kDetectionDelay = 2.0;  // delay until divergence is detected [s]
  static constexpr double kNoGravity = 0.5;       // relative deviation of the mean force from g

  /// An estimate that the restart may begin from.
  struct Before {
    NavState state;
    double sigma_position = 0.0;  ///< [m]
    double sigma_yaw = 0.0;       ///< [rad]
  };
  static Before estimate(const NavState& x, const BodyCovariance& P);

  double gravity_;
  double gap_rate_sigma_;
  MovingStart tilt_;
  bool active_ = false;
  std::optional<Before> before_pause_;
  Time resumed_{0};  ///< end of the pause
  Before before_;
  Time newest_{0};
};

}  // namespace rio

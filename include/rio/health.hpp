// SPDX-License-Identifier: BSD-3-Clause
// How far the estimate can be trusted at this moment, and why not. C++17.
//
// Every reason is a signal over the limit from which it counts: its severity. One rule makes a
// state of them (update/health_monitor.hpp has the signals and their limits):
//   initialising    the radar has not told a velocity since the start
//   ok              all severities below 1
//   degraded        one of 1 and more: the estimate goes on, trust it less
//   dead reckoning  the radar is silent: position and velocity by the IMU alone
//   lost            one of 4 and more, of those that can lose it: do not fly by it
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rio/export.hpp"

namespace rio {

enum class HealthState : std::uint8_t { kInitializing, kOk, kDegraded, kDeadReckoning, kLost };

/// Name of a state, as in "dead reckoning".
RIO_API const char* to_string(HealthState state);

/// Why an estimate is less than ok.
enum class HealthReason : std::uint8_t {
  kRadarSilent,           ///< no scan that told anything for a while
  kFewDetections,         ///< scans arrive, but hardly a measurement is used
  kOutliers,              ///< most detections do not belong to a static world
  kGated,                 ///< the gates refuse many measurements
  kInnovations,           ///< innovations are larger than their sigmas
  kVelocityContradicted,  ///< another velocity explains the Dopplers of a second far better
  kTiltContradicted,      ///< the Dopplers of two seconds show another gravity
  kReopened,              ///< velocity, tilt or heading were replaced: a step
  kImuGaps,               ///< samples were lost, or refused: part of the motion is guessed
  kUncertainPosition,     ///< sigma above 1 m + 5 % of the distance travelled
  kUncertainVelocity,     ///< sigma of an axis above 0.5 m/s
  kUncertainHeading,      ///< sigma above 10 deg
  kUncertainTilt,         ///< sigma above 3 deg
  kTooFast,               ///< no small robot is that fast
  /// A parameter of the calibration has run to its limit, five prior sigmas; or the time offset of
  /// a radar moved in ten seconds by more than five sigmas of before: its clock was changed.
  kCalibration,
  kNumerical,  ///< an update failed and was taken back
  kCount
};
inline constexpr std::size_t kHealthReasonCount = static_cast<std::size_t>(HealthReason::kCount);

/// Name of a reason, as in "radar silent".
RIO_API const char* to_string(HealthReason reason);

/// Severity from which an estimate is lost.
inline constexpr double kHealthLost = 4.0;

struct Health {
  HealthState state = HealthState::kInitializing;  ///< the worst of the three
  HealthState position = HealthState::kInitializing;
  HealthState velocity = HealthState::kInitializing;
  HealthState heading = HealthState::kInitializing;
  /// 0 to 100: 100 / (1 + s^2), s the largest severity. Half of it where degraded begins.
  int quality = 0;
  /// Counts what makes the estimate step: starts, resets, replaced velocities and tilts, restarts
  /// of the clock. Wraps, as the reset_counter of autopilots does.
  std::uint8_t reset_counter = 0;
  std::array<double, kHealthReasonCount> severity{};  ///< signal over limit, by reason

  /// The reason counts.
  bool because(HealthReason reason) const {
    return severity[static_cast<std::size_t>(reason)] >= 1.0;
  }
  /// The estimate has run away: its sigmas say nothing.
  bool has_diverged() const {
    const auto loses = [this](HealthReason reason) {
      return severity[static_cast<std::size_t>(reason)] >= kHealthLost;
    };
    return loses(HealthReason::kTooFast) || loses(HealthReason::kTiltContradicted) ||
           loses(HealthReason::kReopened);
  }
};

}  // namespace rio

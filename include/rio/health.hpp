// SPDX-License-Identifier: BSD-3-Clause
// How far the estimate can be trusted at this moment, and why. C++17.
//
// Every reason has a severity: a signal divided by its limit. The state follows from the severities
// (checks/health_monitor.hpp has the signals and their limits):
//   initialising    the radar has not determined velocity and tilt since the start or a restart, or
//                   its mounting is not known yet
//   ok              all severities below 1, but that of kOneRadarSilent
//   degraded        a severity of 1 or more: the estimate continues with reduced trust
//   dead reckoning  the radar is silent: position and velocity by the IMU alone
//   lost            a severity of 4 or more, of a reason that can lose the estimate: unsafe to fly
//   on
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
  kRadarSilent,           ///< no informative scan for a while
  kFewDetections,         ///< scans arrive, but hardly any measurement is used
  kOutliers,              ///< most detections do not fit a static world
  kGated,                 ///< the gates reject many measurements; for 10 s: the estimate is lost
  kInnovations,           ///< innovations are larger than their sigmas
  kVelocityContradicted,  ///< another velocity explains the Dopplers of a second far better
  kTiltContradicted,      ///< the Dopplers of two seconds show a different gravity direction
  kReopened,              ///< velocity or tilt were replaced, or the heading widened: a jump
  /// Samples were lost or refused: part of the motion is interpolated; 1.2 s of them: the estimate
  /// is lost.
  kImuGaps,
  kUncertainPosition,  ///< sigma above 1 m + 5 % of the distance travelled
  kUncertainVelocity,  ///< sigma of an axis above 0.5 m/s
  kUncertainHeading,   ///< sigma above 10 deg
  kUncertainTilt,      ///< sigma above 3 deg
  kTooFast,            ///< speed above 30 m/s
  /// A calibration parameter has reached its limit of five prior sigmas; or the time offset of a
  /// radar moved within ten seconds by more than five of its former sigmas: its clock was changed.
  kCalibration,
  kNumerical,  ///< an update failed and was undone
  kAiding,     ///< the gates reject measurements of other sensors, or innovations are too large
  /// No scan of one of several radars was processed for two seconds: told, but no doubt of the
  /// estimate, which is as good as the others make it.
  kOneRadarSilent,
  kCount
};
inline constexpr std::size_t kHealthReasonCount = static_cast<std::size_t>(HealthReason::kCount);

/// Name of a reason, as in "radar silent".
RIO_API const char* to_string(HealthReason reason);

/// Severity from which the estimate is lost.
inline constexpr double kHealthLost = 4.0;

struct Health {
  HealthState state = HealthState::kInitializing;  ///< the worst of the three
  HealthState position = HealthState::kInitializing;
  HealthState velocity = HealthState::kInitializing;
  HealthState heading = HealthState::kInitializing;
  /// 0 to 100: 100 / (1 + s^2), s the largest severity. It is 50 where degraded begins.
  int quality = 0;
  /// Counts jumps of the estimate: starts, resets, replaced velocities and tilts, clock restarts.
  /// Wraps, as the reset_counter of autopilots does.
  std::uint8_t reset_counter = 0;
  std::array<double, kHealthReasonCount> severity{};  ///< signal over limit, by reason

  /// Whether this reason is active.
  bool because(HealthReason reason) const {
    return severity[static_cast<std::size_t>(reason)] >= 1.0;
  }
  /// The estimate has diverged: its sigmas are meaningless.
  bool has_diverged() const {
    const auto loses = [this](HealthReason reason) {
      return severity[static_cast<std::size_t>(reason)] >= kHealthLost;
    };
    return loses(HealthReason::kTooFast) || loses(HealthReason::kTiltContradicted) ||
           loses(HealthReason::kReopened);
  }
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The estimate as messages for an autopilot, and a rate limiter. C++17.
//
//   rio::mavlink::Writer writer;
//   rio::mavlink::RateLimiter limiter(30.0);
//   ...
//   if (limiter.due(odometry->now().time)) {
//     const auto message = rio::mavlink::odometry_message(
//         odometry->now(), odometry->covariance_now(), odometry->health(), sample.gyro_B);
//     if (message) send(buffer, writer.write(*message, buffer, sizeof buffer));
//   }
//
// How PX4 and ArduPilot use it:
//   frames     LOCAL_FRD and BODY_FRD: the heading of the world is arbitrary. ArduPilot silently
//              drops any others.
//   type       MAV_ESTIMATOR_TYPE_VIO: there is none for radar, and VIO is nearest: inertial,
//              relative, drifting. PX4 rejects all but UNKNOWN, NAIVE, VISION, VIO and MOCAP, and
//              drops the covariances of NAIVE.
//   covariance PX4 uses the diagonals, with EKF2_EVP_NOISE and so on as lower bounds; ArduPilot
//              has its own noise parameters.
//   NaN        is MAVLink's "unknown". PX4 ignores values that are not finite; whether ArduPilot
//              does is not known: send it complete messages.
//   time       in the clock of the estimate. Both convert it to their own: PX4 needs answers to its
//              TIMESYNC for that (timesync.hpp).
#pragma once

#include <optional>

#include "rio/health.hpp"
#include "rio/mavlink/messages.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

/// Content of the messages.
enum class Content : std::uint8_t {
  kAll,       ///< pose, velocity, and the rates if a gyro sample is given
  kVelocity,  ///< velocity and rates only: position, attitude and their covariance are NaN
  /// kAll, and kVelocity while position or heading are lost and the velocity is not: for an
  /// autopilot that takes NaN for "not known"
  kAllOrVelocity,
};

/// ODOMETRY of an estimate, in axes FRD. `pose_covariance`: position, and rotation about the axes
/// of the local frame; for a level vehicle these are the errors of roll, pitch and yaw.
/// `velocity_covariance`: velocity and rates in body axes.
/// @param now        state and, in P, its covariance: those of now() and covariance_now()
/// @param gyro_B     the gyro sample of that time, bias included [rad/s]; the rates are the sample
///                   minus the bias. Without it the rates and their rows of the covariance are NaN
/// @param gyro_sigma noise of the sample: density x sqrt(rate) [rad/s]
/// @return nothing while health is initialising or lost (for kVelocity the health of the velocity,
///         else the worst of all), or if a number is not finite or beyond 1e9 (SI units), or the
///         stamp is before the epoch
std::optional<OdometryMessage> odometry_message(
    const NavState& now, const BodyCovariance& P, const Health& health,
    const std::optional<Vector3d>& gyro_B = std::nullopt, double gyro_sigma = 0.01,
    Content content = Content::kAll);

/// HEARTBEAT from the health, to be sent once a second: MAV_STATE_CALIBRATING while initialising,
/// ACTIVE if ok, CRITICAL if degraded or dead reckoning, FLIGHT_TERMINATION if lost. Uses the
/// health of the velocity if only that is sent.
Heartbeat heartbeat(const Health& health, Content content = Content::kAll);

/// Passes at most `rate` stamps a second, on average exactly as many if more come. PX4 needs
/// ODOMETRY at 30 to 50 Hz, ArduPilot at 4 Hz or more.
class RateLimiter {
 public:
  /// @param rate [Hz], clamped to 0.001 to 1e6
  explicit RateLimiter(double rate);

  /// Whether the message at `stamp` may be sent. A stamp that jumps back restarts the limiter.
  bool due(Time stamp);

 private:
  Time period_;
  Time last_{0};  ///< last stamp
  Time next_{0};  ///< next due
  bool started_ = false;
};

}  // namespace rio::mavlink

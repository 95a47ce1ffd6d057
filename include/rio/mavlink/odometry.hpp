// SPDX-License-Identifier: BSD-3-Clause
// The estimate as messages for an autopilot, and how often they are due. C++17.
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
// What PX4 and ArduPilot make of it:
//   frames     LOCAL_FRD and BODY_FRD: the heading of the world is arbitrary. ArduPilot drops any
//              others without a word.
//   type       MAV_ESTIMATOR_TYPE_VIO: there is none for radar, PX4 refuses all but UNKNOWN, NAIVE,
//              VISION, VIO and MOCAP, drops the covariances of NAIVE, and VIO is nearest: inertial,
//              relative, drifting.
//   covariance PX4 uses the diagonals, with EKF2_EVP_NOISE and so on as lower bounds; ArduPilot
//              has its own noise parameters.
//   NaN        is MAVLink's "unknown". PX4 leaves out what is not finite; whether ArduPilot does is
//              not known: send it whole messages.
//   time       in the clock of the estimate. Both move it onto their own: PX4 needs answers to its
//              TIMESYNC for that (timesync.hpp).
#pragma once

#include <optional>

#include "rio/health.hpp"
#include "rio/mavlink/messages.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

/// What the messages tell.
enum class Content : std::uint8_t {
  kAll,       ///< pose, velocity, and the rates if a gyro sample is given
  kVelocity,  ///< velocity and rates only: position, attitude and their covariance are NaN
};

/// ODOMETRY of an estimate, in axes FRD. `pose_covariance`: position, and rotation about the axes
/// of the local frame; for a level vehicle these are the errors of roll, pitch and yaw.
/// `velocity_covariance`: velocity and rates in body axes.
/// @param now        estimate and, in P, its covariance: those of now() and covariance_now()
/// @param gyro_B     the gyro sample of that time, bias included [rad/s]; the rates are the sample
///                   minus the bias. Without it the rates and their rows of the covariance are NaN
/// @param gyro_sigma noise of the sample: density x sqrt(rate) [rad/s]
/// @return nothing while health says initialising or lost (of kVelocity the health of the velocity
///         counts, else the worst of all), or if a number is not finite, beyond 1e9 (SI units), or
///         the stamp before the epoch
std::optional<OdometryMessage> odometry_message(
    const NavState& now, const BodyCovariance& P, const Health& health,
    const std::optional<Vector3d>& gyro_B = std::nullopt, double gyro_sigma = 0.01,
    Content content = Content::kAll);

/// HEARTBEAT by health, to be sent once a second: MAV_STATE_CALIBRATING while it starts, ACTIVE,
/// CRITICAL when degraded or dead reckoning, FLIGHT_TERMINATION when lost. The state of the
/// velocity if only that is sent.
Heartbeat heartbeat(const Health& health, Content content = Content::kAll);

/// Lets pass at most `rate` stamps a second, on average as many where more come. PX4 wants ODOMETRY
/// at 30 to 50 Hz, ArduPilot at 4 Hz and more.
class RateLimiter {
 public:
  /// @param rate [Hz], 0.001 to 1e6, else the nearer of these
  explicit RateLimiter(double rate);

  /// The one at `stamp` may be sent. A stamp that falls back starts anew.
  bool due(Time stamp);

 private:
  Time period_;
  Time last_{0};  ///< asked for
  Time next_{0};  ///< due
  bool started_ = false;
};

}  // namespace rio::mavlink

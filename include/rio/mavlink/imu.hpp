// SPDX-License-Identifier: BSD-3-Clause
// The IMU of an autopilot as samples of this library. C++17.
//
// The stamps stay in the clock of the autopilot: subtract TimesyncClient::offset() to have them in
// that of this side, or give the radar's scans the autopilot's clock by adding it.
#pragma once

#include <optional>

#include "rio/mavlink/messages.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

/// Standard gravity, which MAVLink's units of g are made of [m/s^2].
inline constexpr double kStandardGravity = 9.80665;

/// SI units and microseconds: the message to ask an autopilot for (MAV_CMD_SET_MESSAGE_INTERVAL).
/// @return nothing if accelerometer or gyro were not updated (fields_updated), or not finite
std::optional<ImuSample> imu_sample(const HighresImu& message);

/// Grid 0.0098 m/s^2 and 0.001 rad/s; the stamps have a grid of 1 ms. Wraps after 49 days.
ImuSample imu_sample(const ScaledImu& message);

/// What a count of RAW_IMU is; MAVLink leaves it to the sender. ArduPilot sends thousandths of g
/// and of rad/s, as in SCALED_IMU, but with stamps in microseconds.
struct RawImuScale {
  double accel = 1e-3 * kStandardGravity;  ///< [m/s^2]
  double gyro = 1e-3;                      ///< [rad/s]
};
ImuSample imu_sample(const RawImu& message, const RawImuScale& scale = {});

}  // namespace rio::mavlink

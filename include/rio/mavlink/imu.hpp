// SPDX-License-Identifier: BSD-3-Clause
// The IMU of an autopilot as samples of this library. C++17.
//
// The stamps stay in the clock of the autopilot: subtract TimesyncClient::offset() to get them in
// the clock of this side, or add it to the radar stamps to get those in the autopilot's clock.
#pragma once

#include <optional>

#include "rio/mavlink/messages.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

using rio::kStandardGravity;  ///< the unit g of MAVLink

/// SI units and microseconds: the preferred message to request (MAV_CMD_SET_MESSAGE_INTERVAL).
/// @return nothing if accelerometer or gyro were not updated (fields_updated), or not finite
std::optional<ImuSample> imu_sample(const HighresImu& message);

/// Resolution 0.0098 m/s^2 and 0.001 rad/s; stamps in steps of 1 ms. Wraps after 49 days.
ImuSample imu_sample(const ScaledImu& message);

/// Scale of a count of RAW_IMU, which MAVLink leaves to the sender. ArduPilot sends thousandths of
/// g and of rad/s, as in SCALED_IMU, but with stamps in microseconds.
struct RawImuScale {
  double accel = 1e-3 * kStandardGravity;  ///< [m/s^2]
  double gyro = 1e-3;                      ///< [rad/s]
};
/// In SI units by `scale`, axes forward, left, up; stamps from microseconds of the autopilot.
ImuSample imu_sample(const RawImu& message, const RawImuScale& scale = {});

}  // namespace rio::mavlink

// SPDX-License-Identifier: BSD-3-Clause
// The MAVLink messages between an odometry and an autopilot: fields, and their bytes. C++17.
//
// The fields are named and scaled as in common.xml, in MAVLink's axes (axes.hpp converts). visit()
// lists them in the order of the wire: by size, largest first, then the extensions.
//
// Source: common.xml and minimal.xml of MAVLink.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace rio::mavlink {

inline constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Upper triangle of a 6x6 covariance, row by row: the diagonal is 0, 6, 11, 15, 18, 20.
using UpperTriangle = std::array<float, 21>;

struct Heartbeat {
  static constexpr std::uint32_t kId = 0;
  static constexpr std::uint8_t kCrcExtra = 50;
  static constexpr std::size_t kSize = 9;       ///< of the payload, with extensions
  static constexpr std::size_t kBasicSize = 9;  ///< without them: version 1
  std::uint32_t custom_mode = 0;
  std::uint8_t type = 18;      ///< MAV_TYPE_ONBOARD_CONTROLLER
  std::uint8_t autopilot = 8;  ///< MAV_AUTOPILOT_INVALID: not an autopilot
  std::uint8_t base_mode = 0;
  std::uint8_t system_status = 0;  ///< MAV_STATE
  std::uint8_t mavlink_version = 3;

  template <class Message, class Visitor>
  static void visit(Message& m, Visitor&& v) {
    v(m.custom_mode, m.type, m.autopilot, m.base_mode, m.system_status, m.mavlink_version);
  }
};

/// A request if tc1 is 0, else the answer to one.
struct Timesync {
  static constexpr std::uint32_t kId = 111;
  static constexpr std::uint8_t kCrcExtra = 34;
  static constexpr std::size_t kSize = 18;
  static constexpr std::size_t kBasicSize = 16;
  std::int64_t tc1 = 0;  ///< clock of the responder [ns]
  std::int64_t ts1 = 0;  ///< clock of the requester at the request [ns]
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;

  template <class Message, class Visitor>
  static void visit(Message& m, Visitor&& v) {
    v(m.tc1, m.ts1, m.target_system, m.target_component);
  }
};

struct OdometryMessage {
  static constexpr std::uint32_t kId = 331;
  static constexpr std::uint8_t kCrcExtra = 91;
  static constexpr std::size_t kSize = 233;
  static constexpr std::size_t kBasicSize = 230;
  std::uint64_t time_usec = 0;          ///< [us]
  std::array<float, 3> position{};      ///< x y z, axes of frame_id [m]
  std::array<float, 4> q{};             ///< w x y z, maps child_frame_id to frame_id
  std::array<float, 3> velocity{};      ///< axes of child_frame_id [m/s]
  std::array<float, 3> rates{};         ///< roll, pitch, yaw speed, same axes [rad/s]
  UpperTriangle pose_covariance{};      ///< of position and rotation; [0] NaN: unknown
  UpperTriangle velocity_covariance{};  ///< of velocity and rates; [0] NaN: unknown
  std::uint8_t frame_id = 20;           ///< MAV_FRAME_LOCAL_FRD
  std::uint8_t child_frame_id = 12;     ///< MAV_FRAME_BODY_FRD
  std::uint8_t reset_counter = 0;
  std::uint8_t estimator_type = 3;  ///< MAV_ESTIMATOR_TYPE_VIO
  std::int8_t quality = 0;          ///< -1 failed, 0 unknown, 1 to 100 [%]

  template <class Message, class Visitor>
  static void visit(Message& m, Visitor&& v) {
    v(m.time_usec, m.position, m.q, m.velocity, m.rates, m.pose_covariance, m.velocity_covariance,
      m.frame_id, m.child_frame_id, m.reset_counter, m.estimator_type, m.quality);
  }
};

/// An IMU in SI units, body FRD.
struct HighresImu {
  static constexpr std::uint32_t kId = 105;
  static constexpr std::uint8_t kCrcExtra = 93;
  static constexpr std::size_t kSize = 63;
  static constexpr std::size_t kBasicSize = 62;
  std::uint64_t time_usec = 0;   ///< [us]
  std::array<float, 3> accel{};  ///< specific force [m/s^2]
  std::array<float, 3> gyro{};   ///< [rad/s]
  std::array<float, 3> mag{};    ///< [gauss]
  float abs_pressure = 0.0F;     ///< [hPa]
  float diff_pressure = 0.0F;    ///< [hPa]
  float pressure_alt = 0.0F;
  float temperature = 0.0F;          ///< [deg C]
  std::uint16_t fields_updated = 0;  ///< bits 0 to 2 accel, 3 to 5 gyro, and so on
  std::uint8_t id = 0;               ///< which IMU, from 0

  template <class Message, class Visitor>
  static void visit(Message& m, Visitor&& v) {
    v(m.time_usec, m.accel, m.gyro, m.mag, m.abs_pressure, m.diff_pressure, m.pressure_alt,
      m.temperature, m.fields_updated, m.id);
  }
};

/// An IMU in integers of sender-defined scale, body FRD.
struct RawImu {
  static constexpr std::uint32_t kId = 27;
  static constexpr std::uint8_t kCrcExtra = 144;
  static constexpr std::size_t kSize = 29;
  static constexpr std::size_t kBasicSize = 26;
  std::uint64_t time_usec = 0;  ///< [us]
  std::array<std::int16_t, 3> accel{};
  std::array<std::int16_t, 3> gyro{};
  std::array<std::int16_t, 3> mag{};
  std::uint8_t id = 0;           ///< which IMU, from 0
  std::int16_t temperature = 0;  ///< [0.01 deg C]

  template <class Message, class Visitor>
  static void visit(Message& m, Visitor&& v) {
    v(m.time_usec, m.accel, m.gyro, m.mag, m.id, m.temperature);
  }
};

/// An IMU in thousandths, body FRD.
struct ScaledImu {
  static constexpr std::uint32_t kId = 26;
  static constexpr std::uint8_t kCrcExtra = 170;
  static constexpr std::size_t kSize = 24;
  static constexpr std::size_t kBasicSize = 22;
  std::uint32_t time_boot_ms = 0;       ///< [ms]
  std::array<std::int16_t, 3> accel{};  ///< [0.001 g]
  std::array<std::int16_t, 3> gyro{};   ///< [0.001 rad/s]
  std::array<std::int16_t, 3> mag{};    ///< [0.001 gauss]
  std::int16_t temperature = 0;         ///< [0.01 deg C]

  template <class Message, class Visitor>
  static void visit(Message& m, Visitor&& v) {
    v(m.time_boot_ms, m.accel, m.gyro, m.mag, m.temperature);
  }
};

namespace detail {

/// The unsigned number with the bits of a T.
template <class T>
using Bits = std::conditional_t<
    sizeof(T) == 8, std::uint64_t,
    std::conditional_t<sizeof(T) == 4, std::uint32_t,
                       std::conditional_t<sizeof(T) == 2, std::uint16_t, std::uint8_t>>>;

/// Writes a number, little-endian; returns where it ends.
template <class T>
std::uint8_t* put(const T& value, std::uint8_t* at) {
  Bits<T> bits;
  std::memcpy(&bits, &value, sizeof bits);
  for (std::size_t i = 0; i < sizeof bits; ++i) *at++ = static_cast<std::uint8_t>(bits >> 8 * i);
  return at;
}

/// Reads it.
template <class T>
const std::uint8_t* get(const std::uint8_t* at, T* value) {
  Bits<T> bits = 0;
  for (std::size_t i = 0; i < sizeof bits; ++i) {
    bits = static_cast<Bits<T>>(bits | static_cast<Bits<T>>(*at++) << 8 * i);
  }
  std::memcpy(value, &bits, sizeof bits);
  return at;
}

}  // namespace detail

/// Calls use(number) for every number of a message in the order of the wire, those of an array one
/// by one.
template <class Message, class Use>
void for_each_number(Message& message, Use&& use) {
  const auto visit = [&use](auto& field) {
    if constexpr (std::is_arithmetic_v<std::remove_reference_t<decltype(field)>>) {
      use(field);
    } else {
      for (auto& number : field) use(number);
    }
  };
  Message::visit(message, [&visit](auto&... fields) { (visit(fields), ...); });
}

/// @param payload buffer of Message::kSize bytes
template <class Message>
void encode(const Message& message, std::uint8_t* payload) {
  for_each_number(message, [&](const auto& number) { payload = detail::put(number, payload); });
}

/// @param payload Message::kSize bytes, zero-padded if the frame was shorter
template <class Message>
Message decode(const std::uint8_t* payload) {
  Message message;
  for_each_number(message, [&](auto& number) { payload = detail::get(payload, &number); });
  return message;
}

/// What a parser needs to know of a message.
struct MessageKind {
  const char* name = "";
  std::uint32_t id = 0;
  std::uint8_t crc_extra = 0;
  std::size_t basic_size = 0;
};

/// The messages above; null for others.
const MessageKind* find_message(std::uint32_t id);

}  // namespace rio::mavlink

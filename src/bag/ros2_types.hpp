// SPDX-License-Identifier: BSD-3-Clause
// The definitions of the written message types, as rosbag2 and viewers expect them, and their
// encoding.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "byte_writer.hpp"
#include "rio/types.hpp"

namespace rio::bag {

/// The definition of a type, "sensor_msgs/msg/Imu", followed by those of its members, each after a
/// line of "=". The type must be known.
std::string definition_of(const std::string& type);

/// A message that begins with std_msgs/Header. Throws std::runtime_error if the stamp is outside
/// the range of ROS (1970 to 2106).
CdrWriter stamped(Time stamp, const std::string& frame);

/// builtin_interfaces/Time; throws as stamped() does.
void put_time(CdrWriter* message, Time stamp);
/// Three float64: geometry_msgs/Vector3 or Point.
void put_vector(CdrWriter* message, const Vector3d& v);
/// geometry_msgs/Quaternion.
void put_quaternion(CdrWriter* message, const Quaternion& q);

/// Of a point: its name and its type, by the numbers of sensor_msgs/PointField.
struct CloudField {
  const char* name;
  enum : std::uint8_t { kUint8 = 2, kInt16 = 3, kFloat32 = 7 } type = kFloat32;
};
/// sensor_msgs/PointCloud2 of one row; throws as stamped() does.
/// @param fields without gaps between them
/// @param points little-endian
CdrWriter cloud_message(Time stamp, const std::string& frame, std::span<const CloudField> fields,
                        const std::string& points);

}  // namespace rio::bag

// SPDX-License-Identifier: BSD-3-Clause
// The reader of each format; the file must begin with the magic bytes of the format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "rio/bag/message_stream.hpp"

namespace rio::bag {

/// ROS 1 bag 2.0 (wiki.ros.org/Bags/Format/2.0).
std::unique_ptr<MessageStream> open_ros1_bag(const std::filesystem::path& path);
/// MCAP, major version 0 (mcap.dev/spec).
std::unique_ptr<MessageStream> open_mcap(const std::filesystem::path& path);
/// The tables `topics` and `messages` of rosbag2's sqlite3 storage.
std::unique_ptr<MessageStream> open_db3(const std::filesystem::path& path);

inline constexpr char kRos1Magic[] = "#ROSBAG V2.0\n";
inline constexpr char kMcapMagic[] = "\x89MCAP0\r\n";
inline constexpr char kSqliteMagic[] = "SQLite format 3";
inline constexpr char kZstdMagic[] = "\x28\xB5\x2F\xFD";
inline constexpr char kTiMagic[] = "\x02\x01\x04\x03\x06\x05\x08\x07";  ///< of a packet

/// Converts "sensor_msgs/msg/Imu" to "sensor_msgs/Imu".
std::string ros1_type(std::string type);
/// A stamp of the file; throws Damage if it is negative or beyond the year 2116.
Time checked_time(std::int64_t nanoseconds);

}  // namespace rio::bag

// SPDX-License-Identifier: BSD-3-Clause
// The reader of each format, whose magic bytes the file must begin with, and what goes around it.
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
/// The format from the first bytes; a folder by open_folder().
std::unique_ptr<MessageStream> open_file(const std::filesystem::path& path);
/// The recordings in a folder as one. Throws if there is none, or several that do not go together.
std::unique_ptr<MessageStream> open_folder(const std::filesystem::path& folder);

/// What recorders and drivers do to messages, undone: messages compressed one by one, scans sent
/// point by point, receive times after the clock of the recorder was set back. Scans of kTiScanType
/// become one message: the messages of their points, each after its length.
std::unique_ptr<MessageStream> tidied(std::unique_ptr<MessageStream> raw);

/// Kinds of records of MCAP.
namespace mcap {
enum Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kDataEnd = 0x0F
};
}  // namespace mcap

inline constexpr char kRos1Magic[] = "#ROSBAG V2.0\n";
inline constexpr char kMcapMagic[] = "\x89MCAP0\r\n";
inline constexpr char kSqliteMagic[] = "SQLite format 3";
inline constexpr char kZstdMagic[] = "\x28\xB5\x2F\xFD";
inline constexpr char kLz4Magic[] = "\x04\x22\x4D\x18";

/// Converts "sensor_msgs/msg/Imu" to "sensor_msgs/Imu".
std::string ros1_type(std::string type);
/// A stamp of the file; throws Damage if it is negative or beyond the year 2116.
Time checked_time(std::int64_t nanoseconds);

}  // namespace rio::bag

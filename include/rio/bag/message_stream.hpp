// SPDX-License-Identifier: BSD-3-Clause
// ROS recordings as a stream of raw messages: ROS 1 bag 2.0, MCAP, and the sqlite3 files of
// rosbag2. One chunk is in memory at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rio/types.hpp"

namespace rio::bag {

/// Serialisation of the messages of a topic.
enum class Encoding { kRos1, kCdr, kOther };

struct Topic {
  std::string name;
  std::string type;  ///< as in ROS 1, "sensor_msgs/Imu", also for "sensor_msgs/msg/Imu" of ROS 2
  Encoding encoding = Encoding::kOther;
  std::string definition;  ///< text of the message type; empty if the file has none
};

struct Message {
  std::size_t topic = 0;               ///< index in MessageStream::topics()
  Time received{0};                    ///< when it was recorded, clock of the recorder
  std::span<const std::uint8_t> data;  ///< serialised; valid until the next call of next()
};

/// The messages of a file in file order. Lengths in the file are trusted only up to the end of the
/// file, or of the chunk around them.
class MessageStream {
 public:
  explicit MessageStream(std::filesystem::path path) : path_(std::move(path)) {}
  virtual ~MessageStream() = default;
  MessageStream(const MessageStream&) = delete;
  MessageStream& operator=(const MessageStream&) = delete;

  /// False at the end of the file, or at damage: then damage() describes it and no further message
  /// follows.
  /// @throws std::runtime_error if the file needs a library that was missing at build time
  bool next(Message* message);

  /// The topics so far; an index stays valid.
  const std::vector<Topic>& topics() const { return topics_; }
  /// "FILE: byte N: what is wrong", or empty.
  const std::string& damage() const { return damage_; }
  /// "ROS 1 bag", "MCAP" or "rosbag2 sqlite3".
  virtual std::string format() const = 0;
  const std::filesystem::path& path() const { return path_; }

 protected:
  virtual bool read(Message* message) = 0;
  /// The index of the topic with this name, type and encoding; a new topic is added.
  std::size_t topic_index(Topic topic);
  std::vector<Topic> topics_;
  std::string damage_;

 private:
  std::filesystem::path path_;
  bool ended_ = false;
};

/// Whether this is a file, or a folder of recordings, that open_messages() may read.
bool is_recording(const std::filesystem::path& path);
/// Whether it is such a folder, or a file that begins as a recording.
bool begins_as_recording(const std::filesystem::path& path);

/// Guesses the format from the first bytes. For a folder, the one file in it or in a folder below;
/// for the parts of a split recording (with metadata.yaml, or numbered) all files in turn, up to
/// one that is missing, which damage() names; for an IMU and radars recorded apart, all at once.
/// Compressed messages and files (zstd) are decompressed. If the clock of the recorder is set back,
/// the receive times go on. The points of a ti_mmwave_rospkg/RadarScan are one message a scan. IMU
/// messages or clouds of one topic with another frame_id than the first are a topic of their own,
/// NAME@FRAME.
/// @throws std::runtime_error if there is no such file, its format is unknown, a folder holds
/// several recordings, or the library for it was missing at build time
std::unique_ptr<MessageStream> open_messages(const std::filesystem::path& path);

}  // namespace rio::bag

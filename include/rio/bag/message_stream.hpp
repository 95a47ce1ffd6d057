// SPDX-License-Identifier: BSD-3-Clause
// Recordings of ROS as a stream of raw messages: ROS 1 bag 2.0, MCAP, and the sqlite3 files of
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

/// How the messages of a topic are written.
enum class Encoding { kRos1, kCdr, kOther };

struct Topic {
  std::string name;
  std::string
      type;  ///< as in ROS 1, "sensor_msgs/Imu", also where ROS 2 says "sensor_msgs/msg/Imu"
  Encoding encoding = Encoding::kOther;
  std::string definition;  ///< text of the message type; empty where the file has none
};

struct Message {
  std::size_t topic = 0;               ///< index in MessageStream::topics()
  Time received{0};                    ///< when it was recorded, clock of the recorder
  std::span<const std::uint8_t> data;  ///< serialised; valid until the next call of next()
};

/// The messages of a file in the order of the file. Lengths in the file are believed only as far as
/// the file, or the chunk they stand in, reaches.
class MessageStream {
 public:
  explicit MessageStream(std::filesystem::path path) : path_(std::move(path)) {}
  virtual ~MessageStream() = default;
  MessageStream(const MessageStream&) = delete;
  MessageStream& operator=(const MessageStream&) = delete;

  /// False at the end of the file, or where it is damaged: then damage() says so and there is no
  /// further message.
  /// @throws std::runtime_error if the file needs a library that was not there at build time
  bool next(Message* message);

  /// Those met so far; an index stays valid.
  const std::vector<Topic>& topics() const { return topics_; }
  /// "FILE: byte N: what is wrong", or empty.
  const std::string& damage() const { return damage_; }
  /// "ROS 1 bag", "MCAP" or "rosbag2 sqlite3".
  virtual std::string format() const = 0;
  const std::filesystem::path& path() const { return path_; }

 protected:
  virtual bool read(Message* message) = 0;
  /// The index of the topic of this name, type and encoding, which may be new.
  std::size_t topic_index(Topic topic);
  std::vector<Topic> topics_;
  std::string damage_;

 private:
  std::filesystem::path path_;
  bool ended_ = false;
};

/// Whether this is a file, or a folder of rosbag2, that open_messages() may know; a guess from the
/// first bytes, never from the name.
bool is_recording(const std::filesystem::path& path);

/// Guesses the format from the first bytes. Of a folder, the one file in it; of a folder of rosbag2
/// (with metadata.yaml) all files one after the other.
/// @throws std::runtime_error if there is no such file, it is of no known format, or the library
/// for it was not there at build time
std::unique_ptr<MessageStream> open_messages(const std::filesystem::path& path);

}  // namespace rio::bag

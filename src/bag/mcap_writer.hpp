// SPDX-License-Identifier: BSD-3-Clause
// Writer of MCAP files: messages in chunks without compression, each with its checksum and index,
// and a summary at the end. If the file is never closed, everything up to the last complete chunk
// can be read. Format: mcap.dev/spec.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "byte_writer.hpp"
#include "rio/io/text_file.hpp"

namespace rio::bag {

/// All functions throw std::runtime_error if the file cannot be written.
class McapWriter {
 public:
  explicit McapWriter(const std::filesystem::path& path);

  /// A topic of a type of ROS 2, "sensor_msgs/msg/Imu", before the first message.
  /// @param definition text of the type and of its member types
  /// @return its number
  std::uint16_t add_channel(const std::string& topic, const std::string& type,
                            const std::string& definition);
  /// @param time when it was recorded and measured [ns]
  void add(std::uint16_t channel, std::uint64_t time, std::string_view message);

  /// Ends the chunk: added messages are flushed to the system.
  void flush();
  void close();

 private:
  /// Messages of a channel in the chunk: time, offset.
  using Index = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

  struct Span {
    std::uint64_t first = UINT64_MAX, last = 0;
    void add(std::uint64_t time);
  };

  void write(std::uint8_t op, const ByteWriter& content);

  io::TextFile file_;
  std::uint64_t position_ = 0;
  ByteWriter head_;  ///< schemas and channels, which the summary repeats
  ByteWriter chunk_;
  Span chunk_span_;
  std::map<std::uint16_t, Index> chunk_index_;
  Span span_;
  std::map<std::uint16_t, std::uint64_t> messages_;  ///< number per channel
  std::uint32_t chunks_ = 0;
  ByteWriter chunk_records_;  ///< chunk index records for the summary
};

}  // namespace rio::bag

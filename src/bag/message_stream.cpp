// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/message_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "decompress.hpp"
#include "formats.hpp"
#include "recording_folder.hpp"
#include "rio/bag/wire.hpp"
#include "rio/io/csv.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

std::string first_bytes(const fs::path& path) {
  std::string bytes(64, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

}  // namespace

std::unique_ptr<MessageStream> open_file(const fs::path& path) {
  if (fs::is_directory(path)) return open_folder(path);
  const std::string bytes = first_bytes(path);
  if (bytes.starts_with(kRos1Magic)) return open_ros1_bag(path);
  if (bytes.starts_with(kMcapMagic)) return open_mcap(path);
  if (bytes.starts_with(kSqliteMagic)) return open_db3(path);
  if (bytes.starts_with(kZstdMagic)) return open_file(unpacked(path));
  if (bytes.empty()) throw std::runtime_error(path.string() + ": is empty");
  const std::string_view what = io::foreign_file(bytes);
  if (!what.empty()) throw std::runtime_error(fmt::format("{}: {}", path.string(), what));
  throw std::runtime_error(path.string() +
                           ": is no recording: it begins neither as a ROS 1 bag 2.0, nor as an "
                           "MCAP file, nor as an sqlite3 file (.db3); CSV files are given by the "
                           "folder of imu0 and radar0");
}

bool MessageStream::next(Message* message) {
  if (ended_) return false;
  try {
    ended_ = !read(message);
  } catch (const Damage& damage) {
    damage_ = path_.string() + ": byte " + std::to_string(damage.offset) + ": " + damage.what();
    ended_ = true;
  }
  return !ended_;
}

std::size_t MessageStream::topic_index(Topic topic) {
  const auto same = [&](const Topic& t) {
    return t.name == topic.name && t.type == topic.type && t.encoding == topic.encoding;
  };
  const auto known = std::find_if(topics_.begin(), topics_.end(), same);
  const auto index = static_cast<std::size_t>(known - topics_.begin());
  if (known == topics_.end()) topics_.push_back(std::move(topic));
  return index;
}

std::string ros1_type(std::string type) {
  const std::size_t middle = type.find("/msg/");
  if (middle != std::string::npos) type.erase(middle, 4);
  return type;
}

Time checked_time(std::int64_t nanoseconds) {
  constexpr std::int64_t kLimit = std::int64_t{1} << 62;
  if (nanoseconds < 0 || nanoseconds > kLimit) throw Damage(0, "a stamp out of all reason");
  return Time(nanoseconds);
}

bool is_recording(const fs::path& path) {
  if (!fs::exists(path)) return false;
  return fs::is_directory(path) ? !recordings_in(path).empty() : fs::is_regular_file(path);
}

bool begins_as_recording(const fs::path& path) {
  if (!is_recording(path)) return false;
  const std::string bytes = fs::is_directory(path) ? kRos1Magic : first_bytes(path);
  return bytes.starts_with("#ROSBAG V") || bytes.starts_with(kMcapMagic) ||
         bytes.starts_with(kSqliteMagic) || bytes.starts_with(kZstdMagic);
}

std::unique_ptr<MessageStream> open_messages(const fs::path& path) {
  if (!fs::exists(path)) throw std::runtime_error(path.string() + ": no such file");
  return tidied(open_file(path));
}

}  // namespace rio::bag

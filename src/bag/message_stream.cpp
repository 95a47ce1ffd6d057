// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/message_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "formats.hpp"
#include "rio/bag/wire.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

std::string first_bytes(const fs::path& path) {
  std::string bytes(16, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

/// Without a ".zstd" at its end.
fs::path plain_name(const fs::path& path) {
  return path.extension() == ".zstd" || path.extension() == ".zst" ? path.stem() : path.filename();
}

/// Of a part of a split recording, as in "flight_12.db3"; -1 if there is none.
std::int64_t number_of(const fs::path& path) {
  const std::string stem = plain_name(path).stem().string();
  const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
  const std::size_t count = stem.size() - digits;
  return count == 0 || count > 9 ? -1 : std::stoll(stem.substr(digits));
}

/// The files in a folder for which `keep(path)`; parts in the order of their numbers.
template <class Keep>
std::vector<fs::path> files_of(const fs::path& folder, const Keep& keep) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (keep(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(number_of(a), a) < std::pair(number_of(b), b);
  });
  return files;
}

/// Another file in the folder is the better one: unpacked, or mended by rosbag reindex.
bool is_superseded(const fs::path& file) {
  if (plain_name(file) != file.filename()) return fs::exists(file.parent_path() / plain_name(file));
  return file.stem().extension() == ".orig" &&
         fs::exists(file.parent_path() / file.stem().stem().replace_extension(file.extension()));
}

std::vector<fs::path> recordings_in(const fs::path& folder) {
  return files_of(folder, [](const fs::path& file) {
    const fs::path extension = plain_name(file).extension();
    const bool known = extension == ".db3" || extension == ".mcap" || extension == ".bag";
    return known && !is_superseded(file);
  });
}

std::string without_digits(const fs::path& path) {
  std::string name = plain_name(path).string();
  std::erase_if(name, [](char c) { return c >= '0' && c <= '9'; });
  return name;
}

/// The parts of the same recording that rosbag did not close, when it was killed.
std::vector<fs::path> not_closed(const fs::path& folder, const fs::path& part) {
  return files_of(folder, [&](const fs::path& file) {
    return without_digits(file) == without_digits(part) + ".active";
  });
}

/// Whether these are the parts 0, 1, 2... of one recording; ROS 1 puts the time of day before the
/// number. Throws if one in the middle is missing.
bool are_parts(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    if (without_digits(file) != without_digits(files[0])) return false;
  }
  if (number_of(files[0]) != 0) return false;
  for (std::size_t i = 1; i < files.size(); ++i) {
    const std::int64_t before = number_of(files[i - 1]);
    if (number_of(files[i]) <= before) return false;
    if (number_of(files[i]) == before + 1) continue;
    throw std::runtime_error(
        fmt::format("{}: holds several recordings, or part {} of one is missing; name one, as {}",
                    files[0].parent_path().string(), before + 1, files[0].string()));
  }
  return true;
}

std::unique_ptr<MessageStream> open_file(const fs::path& path);

/// Several files as one; damage in one ends the stream.
class Split final : public MessageStream {
 public:
  Split(const fs::path& folder, std::vector<fs::path> files)
      : MessageStream(folder), files_(std::move(files)) {}

  std::string format() const override {
    return "folder of " + std::to_string(files_.size()) + " files, one recording";
  }

 private:
  bool read(Message* message) override {
    for (;;) {
      if (part_ == nullptr) {
        if (next_ == files_.size()) return end();
        part_ = open_file(files_[next_++]);
        numbers_.clear();
      }
      if (part_->next(message)) break;
      damage_ = part_->damage();
      if (!damage_.empty()) return end();
      part_.reset();
    }
    while (numbers_.size() < part_->topics().size()) {
      numbers_.push_back(topic_index(part_->topics()[numbers_.size()]));
    }
    message->topic = numbers_[message->topic];
    return true;
  }

  /// Says what is not read; false.
  bool end() {
    if (next_ < files_.size()) {
      damage_ += fmt::format("; the {} parts after it are not read, from {} on",
                             files_.size() - next_, files_[next_].filename().string());
    }
    for (const fs::path& file : not_closed(path(), files_[0])) {
      damage_ += fmt::format(
          "{}{} was not closed and is not read: rosbag reindex it, then name it "
          "as the others",
          damage_.empty() ? "" : "; ", file.string());
    }
    return false;
  }

  std::vector<fs::path> files_;
  std::size_t next_ = 0;
  std::unique_ptr<MessageStream> part_;
  std::vector<std::size_t> numbers_;  ///< topic of the part -> topic
};

std::unique_ptr<MessageStream> open_folder(const fs::path& folder) {
  std::vector<fs::path> files = recordings_in(folder);
  if (files.size() == 1 && not_closed(folder, files[0]).empty()) return open_file(files.front());
  if (files.empty()) {
    const bool csv = fs::exists(folder / "imu0") || fs::exists(folder / "mav0");
    throw std::runtime_error(folder.string() + (csv ? ": a folder of CSV files, for rio replay and "
                                                      "rio check: it has no topics"
                                                    : ": a folder without a recording"));
  }
  const bool one_kind = std::all_of(files.begin(), files.end(), [&](const fs::path& file) {
    return plain_name(file).extension() == plain_name(files.front()).extension();
  });
  if (one_kind && (are_parts(files) || fs::exists(folder / "metadata.yaml"))) {
    return std::make_unique<Split>(folder, std::move(files));
  }
  throw std::runtime_error(folder.string() + ": holds several recordings; name one, as " +
                           files.front().string());
}

std::unique_ptr<MessageStream> open_file(const fs::path& path) {
  const std::string bytes = first_bytes(path);
  if (bytes.starts_with(kRos1Magic)) return open_ros1_bag(path);
  if (bytes.starts_with(kMcapMagic)) return open_mcap(path);
  if (bytes.starts_with(kSqliteMagic)) return open_db3(path);
  if (bytes.starts_with(kZstdMagic)) return open_file(unpacked(path));
  if (bytes.starts_with("#ROSBAG V") || bytes.starts_with("#ROSRECORD V")) {
    throw std::runtime_error(path.string() + ": a bag older than version 2.0: rosbag fix it first");
  }
  if (bytes.starts_with(kTiMagic)) {
    throw std::runtime_error(path.string() +
                             ": raw packets of a TI radar, without times: record it with rio live "
                             "--radar PORT --imu PORT --record FOLDER");
  }
  if (bytes.empty()) throw std::runtime_error(path.string() + ": is empty");
  if (bytes.starts_with("\x1F\x8B")) {
    throw std::runtime_error(path.string() + ": compressed by gzip: unpack it first");
  }
  throw std::runtime_error(path.string() +
                           ": is no recording: it begins neither as a ROS 1 bag 2.0, nor as an "
                           "MCAP file, nor as an sqlite3 file (.db3)");
}

}  // namespace

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
  return tidied(fs::is_directory(path) ? open_folder(path) : open_file(path));
}

}  // namespace rio::bag

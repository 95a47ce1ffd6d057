// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/message_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "formats.hpp"
#include "io/foreign_file.hpp"
#include "rio/bag/messages.hpp"
#include "rio/bag/wire.hpp"

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
std::vector<fs::path> files_of(const fs::path& folder, const Keep& keep,
                               fs::directory_options how = fs::directory_options::none) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, how)) {
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

std::vector<fs::path> bags_in(const fs::path& folder,
                              fs::directory_options how = fs::directory_options::none) {
  const auto is_bag = [](const fs::path& file) {
    const fs::path extension = plain_name(file).extension();
    const bool known = extension == ".db3" || extension == ".mcap" || extension == ".bag";
    const bool hidden = file.filename().string().starts_with('.');  // "._flight.bag" of macOS
    return known && !hidden && !is_superseded(file) && !fs::is_directory(file);
  };
  return files_of(folder, is_bag, how);
}

/// Its bags; if there are none, the folders in it that have some.
std::vector<fs::path> recordings_in(const fs::path& folder) {
  const std::vector<fs::path> bags = bags_in(folder);
  if (!bags.empty()) return bags;
  return files_of(folder, [](const fs::path& below) {
    constexpr auto kReadable = fs::directory_options::skip_permission_denied;
    return fs::is_directory(below) && !bags_in(below, kReadable).empty();
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

std::unique_ptr<MessageStream> open_file(const fs::path& path);

/// Whether the second file begins where the first one ends.
bool goes_on(const fs::path& first, const fs::path& second) {
  constexpr Time kPause = std::chrono::seconds(5);
  Message message;
  Time end{0};
  const auto before = open_file(first);
  while (before->next(&message)) end = message.received;
  const auto after = open_file(second);
  return after->next(&message) && message.received - end < kPause &&
         end - message.received < kPause;
}

/// Whether files of one name but for the numbers are the parts 0, 1, 2... of one recording; ROS 1
/// puts the time of day before the number. If some are missing, two that follow each other must do
/// so in time.
bool are_parts(const std::vector<fs::path>& files) {
  bool complete = number_of(files[0]) == 0;
  std::size_t next = 0;  // to the one before
  for (std::size_t i = 1; i < files.size(); ++i) {
    const std::int64_t step = number_of(files[i]) - number_of(files[i - 1]);
    if (step <= 0) return false;
    complete = complete && step == 1;
    if (step == 1 && next == 0 && number_of(files[i]) > 0) next = i;
  }
  return complete || (next > 0 && goes_on(files[next - 1], files[next]));
}

/// By the numbers of the parts, in front of one of them; empty if none is missing.
std::string missing_before(const std::vector<fs::path>& files, std::size_t i) {
  const std::int64_t first = i == 0 ? 0 : number_of(files[i - 1]) + 1;
  const std::int64_t last = number_of(files[i]) - 1;
  if (last < first || without_digits(files[i]) != without_digits(files[0])) return {};
  return last == first ? fmt::format("part {} is missing", first)
                       : fmt::format("parts {} to {} are missing", first, last);
}

/// Several files as one.
class Joined : public MessageStream {
 public:
  Joined(const fs::path& folder, std::vector<fs::path> files)
      : MessageStream(folder), files_(std::move(files)) {}

 protected:
  struct Part {
    std::unique_ptr<MessageStream> stream;
    std::vector<std::size_t> numbers;  ///< topic of the part -> topic
    Message message;
  };

  /// Reads its next message; false at its end.
  bool advance(Part* part) {
    if (!part->stream->next(&part->message)) return false;
    while (part->numbers.size() < part->stream->topics().size()) {
      part->numbers.push_back(take_topic(part->stream->topics()[part->numbers.size()]));
    }
    part->message.topic = part->numbers[part->message.topic];
    return true;
  }
  virtual std::size_t take_topic(const Topic& topic) { return topic_index(topic); }

  void add_damage(const std::string& text) {
    if (!text.empty()) damage_ += (damage_.empty() ? "" : "; ") + text;
  }

  std::vector<fs::path> files_;
};

/// The parts of one recording; damage in one ends the stream.
class Split final : public Joined {
 public:
  using Joined::Joined;
  std::string format() const override {
    return "folder of " + std::to_string(files_.size()) + " files, one recording";
  }

 private:
  bool read(Message* message) override {
    for (; part_.stream != nullptr || open_next(); part_ = {}) {
      if (advance(&part_)) {
        *message = part_.message;
        return true;
      }
      add_damage(part_.stream->damage());
      if (!damage_.empty()) break;
    }
    return end();
  }

  /// False if none is left, or with damage.
  bool open_next() {
    if (next_ == files_.size()) return false;
    const std::string missing = next_ == 0 ? "" : missing_before(files_, next_);
    if (!missing.empty()) {
      add_damage(path().string() + ": " + missing);
      return false;
    }
    try {
      part_.stream = open_file(files_[next_++]);
    } catch (const std::runtime_error& error) {
      if (next_ == 1) throw;
      add_damage(error.what());
    }
    return damage_.empty();
  }

  /// Says what is not read; false.
  bool end() {
    if (next_ < files_.size()) {
      add_damage(fmt::format("the {} parts after it are not read, from {} on",
                             files_.size() - next_, files_[next_].filename().string()));
    }
    const std::string begin = missing_before(files_, 0);
    if (!begin.empty()) {
      add_damage(fmt::format("{}: {}, the recording begins with {}", path().string(), begin,
                             files_[0].filename().string()));
    }
    for (const fs::path& file : not_closed(path(), files_[0])) {
      add_damage(file.string() +
                 " was not closed and is not read: rosbag reindex it, then name it as the others");
    }
    return false;
  }

  std::size_t next_ = 0;
  Part part_{};
};

/// Recordings of other sensors at the same time, by the times of their messages. Throws if they
/// have an IMU or a radar in common.
class Parallel final : public Joined {
 public:
  Parallel(const fs::path& folder, std::vector<fs::path> files,
           std::vector<std::unique_ptr<MessageStream>> streams)
      : Joined(folder, std::move(files)), count_(streams.size()) {
    for (std::unique_ptr<MessageStream>& stream : streams) {
      parts_.push_back({std::move(stream), {}, {}});
      if (!advance(&parts_.back())) drop(parts_.size() - 1);
    }
    for (const Part& part : parts_) {
      constexpr Time kTogether = std::chrono::seconds(60);
      if (part.message.received - parts_[0].message.received > kTogether ||
          parts_[0].message.received - part.message.received > kTogether) {
        fail();
      }
    }
  }
  std::string format() const override {
    return "folder of " + std::to_string(count_) + " recordings at the same time";
  }

 private:
  bool read(Message* message) override {
    if (given_ < parts_.size() && !advance(&parts_[given_])) drop(given_);
    const auto first = std::min_element(
        parts_.begin(), parts_.end(),
        [](const Part& a, const Part& b) { return a.message.received < b.message.received; });
    if (first == parts_.end()) return false;
    given_ = static_cast<std::size_t>(first - parts_.begin());
    *message = first->message;
    return true;
  }

  void drop(std::size_t part) {
    add_damage(parts_[part].stream->damage());
    parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(part));
  }

  std::size_t take_topic(const Topic& topic) override {
    const bool is_sensor = is_imu(topic.type) || is_cloud(topic.type);
    for (const Topic& known : topics_) {
      if (is_sensor && known.name == topic.name) fail();
    }
    return topic_index(topic);
  }

  [[noreturn]] void fail() const {
    std::string missing;
    for (std::size_t i = 1; i < files_.size() && missing.empty(); ++i) {
      missing = missing_before(files_, i);
    }
    throw std::runtime_error(fmt::format("{}: holds several recordings{}{}; name one, as {}",
                                         path().string(), missing.empty() ? "" : ", or ", missing,
                                         files_[0].string()));
  }

  std::size_t count_;
  std::vector<Part> parts_;
  std::size_t given_ = std::string::npos;  ///< part of the last message
};

std::unique_ptr<MessageStream> open_folder(const fs::path& folder) {
  const std::vector<fs::path> files = recordings_in(folder);
  if (files.empty()) {
    const bool csv = fs::exists(folder / "imu0") || fs::exists(folder / "mav0");
    throw std::runtime_error(folder.string() + (csv ? ": a folder of CSV files, for rio replay and "
                                                      "rio check: it has no topics"
                                                    : ": a folder without a recording"));
  }
  const bool listed = fs::exists(folder / "metadata.yaml");
  std::map<std::string, std::vector<fs::path>> groups;  // of parts
  for (const fs::path& file : files) {
    const std::string extension = plain_name(file).extension().string();
    groups[listed ? extension : without_digits(file)].push_back(file);
  }
  std::vector<std::unique_ptr<MessageStream>> streams;
  for (const auto& [name, group] : groups) {
    const bool several = group.size() > 1 || !not_closed(folder, group[0]).empty();
    if (several && !fs::is_directory(group[0]) && (listed || are_parts(group))) {
      streams.push_back(std::make_unique<Split>(folder, group));
      continue;
    }
    for (const fs::path& file : group) streams.push_back(open_file(file));
  }
  if (streams.size() == 1) return std::move(streams[0]);
  return std::make_unique<Parallel>(folder, files, std::move(streams));
}

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
  return tidied(open_file(path));
}

}  // namespace rio::bag

// SPDX-License-Identifier: BSD-3-Clause
// The recordings of a folder as one: the parts of a split recording in turn, those of other sensors
// side by side.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <stdexcept>
#include <utility>

#include "formats.hpp"
#include "recording_folder.hpp"
#include "rio/bag/messages.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

/// Whether the second file begins where the first one ends.
bool goes_on(const fs::path& first, const fs::path& second) {
  constexpr Time kPause = std::chrono::seconds(5);
  Message message;
  Time end{0};
  const auto before = open_file(first);
  while (before->next(&message)) end = message.received;
  const auto after = open_file(second);
  return after->next(&message) && std::chrono::abs(message.received - end) < kPause;
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
    if (next_ == files_.size()) {
      const std::string after = missing_after(files_);
      if (!after.empty()) add_damage(path().string() + ": " + after);
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
      const Time apart = part.message.received - parts_[0].message.received;
      if (std::chrono::abs(apart) > kTogether) fail();
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

}  // namespace

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
    const bool several =
        group.size() > 1 || !not_closed(folder, group[0]).empty() || !missing_after(group).empty();
    if (several && !fs::is_directory(group[0]) && (listed || are_parts(group))) {
      streams.push_back(std::make_unique<Split>(folder, group));
      continue;
    }
    for (const fs::path& file : group) streams.push_back(open_file(file));
  }
  if (streams.size() == 1) return std::move(streams[0]);
  return std::make_unique<Parallel>(folder, files, std::move(streams));
}

}  // namespace rio::bag

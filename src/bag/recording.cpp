// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "io/doppler_grid.hpp"
#include "rio/bag/messages.hpp"
#include "rio/bag/summary.hpp"
#include "trigger.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

/// The stamps of one topic while it is read.
struct Stamps {
  std::vector<Time> header;
  std::vector<Time> received;
  std::vector<std::uint32_t> sequence;

  bool any_zero() const { return std::find(header.begin(), header.end(), Time(0)) != header.end(); }
  /// Median of receive - header; headers that are zero do not count.
  Time delay() const {
    std::vector<Time> delays;
    for (std::size_t i = 0; i < header.size(); ++i) {
      if (header[i] != Time(0)) delays.push_back(received[i] - header[i]);
    }
    if (delays.empty()) return Time(0);
    const auto middle = delays.begin() + static_cast<std::ptrdiff_t>(delays.size() / 2);
    std::nth_element(delays.begin(), middle, delays.end());
    return *middle;
  }
};

/// A topic, what it is for in messages, and what was left out of it.
struct Source {
  const char* role;
  std::string type;
  std::string name;
  Stamps stamps;
  std::size_t unreadable = 0;
  std::string first_error;
  bool wanted = true;

  bool fits(const Topic& topic) const {
    return topic.encoding != Encoding::kOther &&
           (topic.type == type || (type == kCloudType && is_cloud(topic.type)) ||
            (type == kHeaderType && !name.empty() && begins_with_header(topic)));
  }
};

std::string topic_list(const Summary& summary) {
  std::string text;
  for (const TopicSummary& s : summary.topics) {
    text += fmt::format("\n  {} {} ({} messages)", s.topic.name, s.topic.type, s.messages);
  }
  return text.empty() ? "\n  none" : text;
}

/// The topic asked for, or the only one of the type.
std::string choose_topic(const Summary& summary, const fs::path& path, const Source& source) {
  std::string found;
  std::string wrong_type;  // of the topic asked for
  for (const TopicSummary& s : summary.topics) {
    const bool named = source.name.empty() || s.topic.name == source.name;
    if (named && !source.name.empty()) wrong_type = s.topic.type;
    if (!named || s.messages == 0 || !source.fits(s.topic)) continue;
    if (!found.empty()) {
      throw std::runtime_error(fmt::format("{}: several topics of type {}; choose with --{}:{}",
                                           path.string(), source.type, source.role,
                                           topic_list(summary)));
    }
    found = s.topic.name;
  }
  if (!found.empty()) return found;
  if (!wrong_type.empty()) {
    throw std::runtime_error(fmt::format("{}: topic {} is of type {}; read is {}", path.string(),
                                         source.name, wrong_type, source.type));
  }
  throw std::runtime_error(fmt::format("{}: no topic {}; there are{}{}", path.string(),
                                       source.name.empty() ? "of type " + source.type : source.name,
                                       topic_list(summary),
                                       summary.damage.empty() ? "" : "\n" + summary.damage));
}

/// Decodes the messages of both topics.
class Reader {
 public:
  Reader(const fs::path& path, const RecordingRequest& request)
      : path_(path), request_(request), stream_(open_messages(path)) {
    imu_.name = request.imu_topic;
    radar_.name = request.radar_topic;
    trigger_.name = request.trigger_topic;
    trigger_.wanted = request.radar_clock == Clock::kTrigger;
    if (request.imu_clock == Clock::kTrigger) {
      throw std::runtime_error("the clock \"trigger\" is for the radar alone");
    }
    const Summary summary = summarise(open_messages(path).get());
    for (Source* source : sources()) source->name = choose_topic(summary, path, *source);
  }

  Recording run() {
    Message message;
    while (stream_->next(&message)) {
      const Topic& topic = stream_->topics()[message.topic];
      for (Source* source : sources()) {
        if (topic.name == source->name && source->fits(topic)) decode(source, topic, message);
      }
    }
    for (const Source* source : sources()) require_some(*source);
    put_on_one_clock();
    tell();
    return {std::move(data_), stream_->damage()};
  }

 private:
  std::vector<Source*> sources() {
    if (!trigger_.wanted) return {&imu_, &radar_};
    return {&imu_, &radar_, &trigger_};
  }

  void note(std::string text) { data_.notes.push_back(std::move(text)); }

  void decode(Source* source, const Topic& topic, const Message& message) {
    try {
      Header header;
      if (source == &imu_) {
        ImuSample sample = decode_imu(topic.encoding, message.data, &header);
        sample.gyro_B *= request_.gyro_unit;
        sample.accel_B *= request_.accel_unit;
        data_.imu.push_back(sample);
      } else if (source == &trigger_) {
        header = decode_header(topic.encoding, message.data);
      } else {
        const PointCloud cloud = decode_cloud_of(topic, message.data);
        header = cloud.header;
        add_scan(cloud);
      }
      source->stamps.header.push_back(header.stamp);
      source->stamps.received.push_back(message.received);
      source->stamps.sequence.push_back(header.sequence);
    } catch (const Damage& damage) {
      if (source->unreadable++ == 0) {
        source->first_error = fmt::format("byte {}: {}", damage.offset, damage.what());
      }
    }
  }

  void add_scan(const PointCloud& cloud) {
    RadarScan scan;
    if (cloud.size() > 0) {
      if (!map_ || map_->fields() != cloud.fields) {
        map_.emplace(cloud.fields, request_.points);
        note("points, " + map_->text());
      }
      points_left_out_ += map_->convert(cloud, &scan.detections);
    }
    data_.scans.push_back(std::move(scan));
  }

  void require_some(const Source& source) const {
    if (!source.stamps.header.empty()) return;
    throw std::runtime_error(
        fmt::format("{}: no readable message on {}{}{}", path_.string(), source.name,
                    source.first_error.empty() ? "" : "; the first one, " + source.first_error,
                    stream_->damage().empty() ? "" : "; " + stream_->damage()));
  }

  void put_on_one_clock() {
    Clock imu = request_.imu_clock;
    Clock radar = request_.radar_clock;
    const Source& other = trigger_.wanted ? trigger_ : radar_;
    const bool headers = !imu_.stamps.any_zero() && !other.stamps.any_zero();
    const double apart = to_seconds(imu_.stamps.delay()) - to_seconds(other.stamps.delay());
    if (imu == Clock::kAuto && radar == Clock::kAuto && headers && std::abs(apart) < 1.0) {
      imu = radar = Clock::kHeader;
    }
    const bool stamped = radar == Clock::kHeader || radar == Clock::kTrigger;
    if (imu == Clock::kAuto && stamped) imu = Clock::kHeader;
    if (radar == Clock::kAuto && imu == Clock::kHeader) radar = Clock::kHeader;
    if (headers && std::abs(apart) >= 1.0) {
      note(fmt::format("the header clocks of IMU and {} are {:.3f} s apart", other.role,
                       std::abs(apart)));
    }
    stamp(&data_.imu, imu_, imu, request_.imu_offset);
    if (radar == Clock::kTrigger) {
      stamp_by_triggers();
    } else {
      stamp(&data_.scans, radar_, radar, request_.radar_offset);
    }
    const auto repeated =
        std::unique(data_.scans.begin(), data_.scans.end(),
                    [](const auto& a, const auto& b) { return a.time == b.time; });
    if (repeated != data_.scans.end()) {
      note(fmt::format("{} scans have the stamp of the scan before and are left out",
                       data_.scans.end() - repeated));
      data_.scans.erase(repeated, data_.scans.end());
    }
  }

  /// Scans without a trigger are left out.
  void stamp_by_triggers() {
    const std::vector<std::uint32_t>& numbers = trigger_.stamps.sequence;
    const bool counted = std::any_of(numbers.begin(), numbers.end(), [](auto n) { return n > 0; });
    if (request_.trigger_match == TriggerMatch::kSequence && !counted) {
      throw std::runtime_error(path_.string() + ": messages on " + trigger_.name +
                               " have no sequence numbers, as in ROS 2; match \"earlier\" does "
                               "without");
    }
    require_no_zero(trigger_);
    Triggers triggers(request_.trigger_match);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      triggers.add(numbers[i], trigger_.stamps.header[i], trigger_.stamps.received[i]);
    }
    triggers.sort();
    std::vector<RadarScan> kept;
    for (std::size_t i = 0; i < data_.scans.size(); ++i) {
      const auto time = triggers.find(radar_.stamps.sequence[i], radar_.stamps.received[i]);
      if (!time) continue;
      data_.scans[i].time = *time + from_seconds(request_.radar_offset);
      kept.push_back(std::move(data_.scans[i]));
    }
    const std::size_t all = std::exchange(data_.scans, std::move(kept)).size();
    if (data_.scans.empty()) {
      throw std::runtime_error(fmt::format("{}: no scan on {} has a trigger on {}", path_.string(),
                                           radar_.name, trigger_.name));
    }
    note(
        fmt::format("{}: {} messages, {} stamped by the last trigger before on {}{}{}; {} without "
                    "one are left out",
                    radar_.name, all, data_.scans.size(), trigger_.name,
                    request_.trigger_match == TriggerMatch::kSequence ? ", of the same number" : "",
                    moved_text(request_.radar_offset), all - data_.scans.size()));
  }

  static std::string moved_text(double offset) {
    return offset == 0.0 ? "" : fmt::format(", and moved by {} s", offset);
  }

  void require_no_zero(const Source& source) const {
    const std::vector<Time>& header = source.stamps.header;
    const auto zeros = std::count(header.begin(), header.end(), Time(0));
    if (zeros == 0) return;
    throw std::runtime_error(fmt::format(
        "{}: {} of {} header stamps on {} are zero{}", path_.string(), zeros, header.size(),
        source.name,
        &source == &trigger_ ? "" : fmt::format("; use --{}-clock receive", source.role)));
  }

  template <class Item>
  void stamp(std::vector<Item>* items, const Source& source, Clock clock, double offset) {
    const Stamps& stamps = source.stamps;
    const bool zero = stamps.any_zero();
    if (clock == Clock::kAuto) clock = zero ? Clock::kReceive : Clock::kCarried;
    const auto zeros = std::count(stamps.header.begin(), stamps.header.end(), Time(0));
    if (clock != Clock::kReceive) require_no_zero(source);
    const Time delay = clock == Clock::kCarried ? stamps.delay() : Time(0);
    const std::vector<Time>& from = clock == Clock::kReceive ? stamps.received : stamps.header;
    for (std::size_t i = 0; i < items->size(); ++i) {
      (*items)[i].time = from[i] + delay + from_seconds(offset);
    }
    std::string text = clock == Clock::kReceive  ? "stamped when they were received"
                       : clock == Clock::kHeader ? "stamped by their headers"
                                                 : fmt::format(
                                                       "stamped by their headers, moved by "
                                                       "{:.9f} s onto the receive clock",
                                                       to_seconds(delay));
    if (zero) text += fmt::format(" ({} header stamps are zero)", zeros);
    if (offset != 0.0) text += fmt::format(", and by {} s", offset);
    note(fmt::format("{}: {} messages, {}", source.name, items->size(), text));
    if (clock != Clock::kHeader && source.role == radar_.role && offset == 0.0) {
      note("scans arrive later than they were measured: --radar-offset, below zero");
    }
  }

  /// What the sensor files would have said, and what was left out.
  void tell() {
    if (!request_.mounting_is_known) {
      note(
          "no mounting in a recording: radar pose from the options, by default at the body origin");
    }
    data_.imu_info.rate_hz = rate(data_.imu);
    data_.radar_info.rate_hz = rate(data_.scans);
    data_.radar_info.doppler_resolution = io::doppler_grid(data_.scans);
    if (data_.radar_info.doppler_resolution) {
      note(
          fmt::format("the Doppler has steps of {:.4f} m/s", *data_.radar_info.doppler_resolution));
    }
    if (points_left_out_ > 0) {
      note(fmt::format("{} points are not finite and are left out", points_left_out_));
    }
    for (const Source* source : sources()) {
      if (source->unreadable == 0) continue;
      note(fmt::format("{}: {} messages cannot be read and are left out; the first one, {}",
                       source->name, source->unreadable, source->first_error));
    }
  }

  template <class Item>
  static std::optional<double> rate(const std::vector<Item>& items) {
    const double span = to_seconds(items.back().time) - to_seconds(items.front().time);
    if (!(span > 0.0)) return std::nullopt;
    return static_cast<double>(items.size() - 1) / span;
  }

  fs::path path_;
  RecordingRequest request_;
  std::unique_ptr<MessageStream> stream_;
  Source imu_{"imu", kImuType, {}, {}, 0, {}};
  Source radar_{"radar", kCloudType, {}, {}, 0, {}};
  Source trigger_{"trigger", kHeaderType, {}, {}, 0, {}, false};
  std::optional<PointMap> map_;
  std::size_t points_left_out_ = 0;
  io::Dataset data_;
};

}  // namespace

Recording read_recording(const fs::path& path, const RecordingRequest& request) {
  return Reader(path, request).run();
}

}  // namespace rio::bag

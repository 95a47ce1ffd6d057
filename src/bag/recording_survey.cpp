// SPDX-License-Identifier: BSD-3-Clause
#include "recording_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <exception>
#include <stdexcept>
#include <utility>

#include "io/doppler_grid.hpp"
#include "rio/bag/summary.hpp"
#include "trigger.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

/// The stamps of one topic, while it is read.
struct Stamps {
  std::size_t count = 0;
  std::size_t zeros = 0;    ///< of the headers
  std::deque<Time> delays;  ///< receive - header; without zero headers
  Header first, last;
  Time first_received{0}, last_received{0};
  /// One a message, where all are needed.
  bool all = true;
  std::vector<Time> header;
  std::vector<Time> received;
  std::vector<std::uint32_t> sequence;

  void add(const Header& head, Time when) {
    if (count++ == 0) {
      first = head;
      first_received = when;
    }
    last = head;
    last_received = when;
    if (head.stamp == Time(0)) {
      ++zeros;
    } else {
      delays.push_back(when - head.stamp);
    }
    if (!all) return;
    header.push_back(head.stamp);
    received.push_back(when);
    sequence.push_back(head.sequence);
  }
  /// Median of the delays; sorts them partially.
  Time delay() {
    if (delays.empty()) return Time(0);
    const auto middle = delays.begin() + static_cast<std::ptrdiff_t>(delays.size() / 2);
    std::nth_element(delays.begin(), middle, delays.end());
    return *middle;
  }
};

/// A topic, and what was dropped from it.
struct Source : Role {
  Stamps stamps{};
  std::size_t unreadable = 0;
  std::string first_error{};
  bool wanted = true;
};

std::string topic_list(const Summary& summary) {
  std::string text;
  for (const TopicSummary& s : summary.topics) {
    text += fmt::format("\n  {} {} ({} messages)", s.topic.name, s.topic.type, s.messages);
  }
  return text.empty() ? "\n  none" : text;
}

/// The requested topic, or the only one of the type.
std::string choose_topic(const Summary& summary, const fs::path& path, const Role& source) {
  std::string found;
  std::string wrong_type;  // of the requested topic
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

class Survey {
 public:
  Survey(const fs::path& path, const RecordingRequest& request)
      : path_(path), request_(request), stream_(open_messages(path)), clouds_(request.points) {
    imu_.name = request.imu_topic;
    radar_.name = request.radar_topic;
    trigger_.name = request.trigger_topic;
    trigger_.wanted = request.radar_clock == Clock::kTrigger;
    imu_.stamps.all = false;
    if (request.imu_clock == Clock::kTrigger) {
      throw std::runtime_error("the clock \"trigger\" is for the radar alone");
    }
  }

  Surveyed run() {
    const Summary summary =
        summarise(stream_.get(), [this](const Message& message) { use(message); });
    for (Source* source : sources()) source->name = choose_topic(summary, path_, *source);
    if (failed_) std::rethrow_exception(failed_);
    for (const Source* source : sources()) require_some(*source);
    put_on_one_clock();
    tell();
    out_.outline.damage = stream_->damage();
    out_.imu = imu_;
    out_.radar = radar_;
    return std::move(out_);
  }

 private:
  std::vector<Source*> sources() {
    if (!trigger_.wanted) return {&imu_, &radar_};
    return {&imu_, &radar_, &trigger_};
  }

  void note(std::string text) { notes_.push_back(std::move(text)); }

  /// For each possible source; the choice is made at the end, and is needed to count the errors of
  /// the points.
  void use(const Message& message) {
    while (uses_.size() < stream_->topics().size()) {
      const Topic& topic = stream_->topics()[uses_.size()];
      uses_.emplace_back();
      for (Source* source : sources()) {
        if (source->fits(topic)) uses_.back().push_back(source);
      }
    }
    if (failed_) return;
    try {
      for (Source* source : uses_[message.topic]) {
        decode(source, stream_->topics()[message.topic], message);
      }
    } catch (const std::exception&) {
      failed_ = std::current_exception();
    }
  }

  void decode(Source* source, const Topic& topic, const Message& message) {
    try {
      Header header;
      if (source == &imu_) {
        (void)imu_sample(topic, message, request_, &header);
      } else if (source == &trigger_) {
        header = decode_header(topic.encoding, message.data);
      } else {
        clouds_.read(topic, message, &header, &scan_.detections, &notes_);
        grid_.add(scan_);
      }
      source->stamps.add(header, message.received);
    } catch (const Damage& damage) {
      if (source->unreadable++ == 0) {
        source->first_error = fmt::format("byte {}: {}", damage.offset, damage.what());
      }
    }
  }

  void require_some(const Source& source) const {
    if (source.stamps.count > 0) return;
    throw std::runtime_error(
        fmt::format("{}: no readable message on {}{}{}", path_.string(), source.name,
                    source.first_error.empty() ? "" : "; the first one, " + source.first_error,
                    stream_->damage().empty() ? "" : "; " + stream_->damage()));
  }

  void put_on_one_clock() {
    Clock imu = request_.imu_clock;
    Clock radar = request_.radar_clock;
    Source& other = trigger_.wanted ? trigger_ : radar_;
    const bool headers = imu_.stamps.zeros == 0 && other.stamps.zeros == 0;
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
    stamp_imu(imu);
    std::vector<Time>& times = out_.outline.scan_times.emplace_back();
    if (radar == Clock::kTrigger) {
      stamp_by_triggers(&times);
    } else {
      stamp_scans(radar, &times);
    }
    leave_out_repeated(&times);
  }

  void leave_out_repeated(std::vector<Time>* times) {
    std::size_t count = 0;  // of the kept ones
    for (std::size_t i = 0, k = 0; i < out_.kept.size(); ++i) {
      if (!out_.kept[i]) continue;
      const Time time = (*times)[k++];
      if (count > 0 && (*times)[count - 1] == time) {
        out_.kept[i] = false;
      } else {
        (*times)[count++] = time;
      }
    }
    if (count < times->size()) {
      note(fmt::format("{} scans have the stamp of the scan before and are left out",
                       times->size() - count));
      times->resize(count);
    }
  }

  /// Scans without a trigger are dropped.
  void stamp_by_triggers(std::vector<Time>* times) {
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
    const std::size_t all = radar_.stamps.count;
    for (std::size_t i = 0; i < all; ++i) {
      const auto time = triggers.find(radar_.stamps.sequence[i], radar_.stamps.received[i]);
      out_.kept.push_back(time.has_value());
      if (time) times->push_back(*time + from_seconds(request_.radar_offset));
    }
    if (times->empty()) {
      throw std::runtime_error(fmt::format("{}: no scan on {} has a trigger on {}", path_.string(),
                                           radar_.name, trigger_.name));
    }
    note(
        fmt::format("{}: {} messages, {} stamped by the last trigger before on {}{}{}; {} without "
                    "one are left out",
                    radar_.name, all, times->size(), trigger_.name,
                    request_.trigger_match == TriggerMatch::kSequence ? ", of the same number" : "",
                    moved_text(request_.radar_offset), all - times->size()));
  }

  static std::string moved_text(double offset) {
    return offset == 0.0 ? "" : fmt::format(", and moved by {} s", offset);
  }

  void require_no_zero(const Source& source) const {
    if (source.stamps.zeros == 0) return;
    throw std::runtime_error(fmt::format(
        "{}: {} of {} header stamps on {} are zero{}", path_.string(), source.stamps.zeros,
        source.stamps.count, source.name,
        &source == &trigger_ ? "" : fmt::format("; use --{}-clock receive", source.role)));
  }

  void stamp_imu(Clock clock) {
    const auto [received, shift] = decide(&imu_, clock, request_.imu_offset);
    const Stamps& stamps = imu_.stamps;
    out_.imu_received = received;
    out_.imu_shift = shift;
    out_.outline.imu_samples = stamps.count;
    out_.outline.imu_begin = (received ? stamps.first_received : stamps.first.stamp) + shift;
    out_.outline.imu_end = (received ? stamps.last_received : stamps.last.stamp) + shift;
  }

  void stamp_scans(Clock clock, std::vector<Time>* times) {
    const auto [received, shift] = decide(&radar_, clock, request_.radar_offset);
    *times = received ? radar_.stamps.received : radar_.stamps.header;
    for (Time& time : *times) time += shift;
    out_.kept.assign(times->size(), true);
  }

  /// Whether a topic is stamped with receive times, and the shift of its stamps.
  std::pair<bool, Time> decide(Source* source, Clock clock, double offset) {
    Stamps& stamps = source->stamps;
    const bool zero = stamps.zeros > 0;
    if (clock == Clock::kAuto) clock = zero ? Clock::kReceive : Clock::kCarried;
    if (clock != Clock::kReceive) require_no_zero(*source);
    const Time delay = clock == Clock::kCarried ? stamps.delay() : Time(0);
    std::string text = clock == Clock::kReceive  ? "stamped when they were received"
                       : clock == Clock::kHeader ? "stamped by their headers"
                                                 : fmt::format(
                                                       "stamped by their headers, moved by "
                                                       "{:.9f} s onto the receive clock",
                                                       to_seconds(delay));
    if (zero) text += fmt::format(" ({} header stamps are zero)", stamps.zeros);
    if (offset != 0.0) text += fmt::format(", and by {} s", offset);
    note(fmt::format("{}: {} messages, {}", source->name, stamps.count, text));
    if (clock != Clock::kHeader && source == &radar_ && offset == 0.0) {
      note("scans arrive later than they were measured: --radar-offset, below zero");
    }
    return {clock == Clock::kReceive, delay + from_seconds(offset)};
  }

  /// Notes on missing sensor files and dropped data.
  void tell() {
    if (!request_.mounting_is_known) {
      note(
          "no mounting in a recording: radar pose from the options, by default at the body origin");
    }
    io::RecordingOutline& outline = out_.outline;
    io::RadarInfo& info = outline.sensors.radar_info;
    const std::vector<Time>& times = outline.scan_times[0];
    outline.sensors.imu_info.rate_hz =
        rate(outline.imu_begin, outline.imu_end, outline.imu_samples);
    info.rate_hz = rate(times.front(), times.back(), times.size());
    info.doppler_resolution = doppler_grid();
    if (info.doppler_resolution) {
      note(fmt::format("the Doppler has steps of {:.4f} m/s", *info.doppler_resolution));
    }
    if (clouds_.points_left_out() > 0) {
      note(fmt::format("{} points are not finite and are left out", clouds_.points_left_out()));
    }
    for (const Source* source : sources()) {
      if (source->unreadable == 0) continue;
      note(fmt::format("{}: {} messages cannot be read and are left out; the first one, {}",
                       source->name, source->unreadable, source->first_error));
    }
    outline.sensors.notes = std::move(notes_);
  }

  /// Of the scans of the outline.
  std::optional<double> doppler_grid() {
    const auto each_scan = [this](const auto& use) {
      const std::unique_ptr<MessageStream> stream = open_messages(path_);
      CloudReader clouds(request_.points);
      Message message;
      Header header;
      RadarScan scan;
      bool go_on = true;
      for (std::size_t i = 0; go_on && i < out_.kept.size() && stream->next(&message);) {
        const Topic& topic = stream->topics()[message.topic];
        if (!radar_.fits(topic)) continue;
        try {
          clouds.read(topic, message, &header, &scan.detections, nullptr);
        } catch (const Damage&) {
          continue;
        }
        if (out_.kept[i++]) go_on = use(scan);
      }
    };
    if (out_.outline.scan_times[0].size() == out_.kept.size()) return grid_.step(each_scan);
    io::DopplerGrid of_kept;
    each_scan([&of_kept](const RadarScan& scan) {
      of_kept.add(scan);
      return true;
    });
    return of_kept.step(each_scan);
  }

  static std::optional<double> rate(Time begin, Time end, std::size_t count) {
    const double span = to_seconds(end) - to_seconds(begin);
    if (!(span > 0.0)) return std::nullopt;
    return static_cast<double>(count - 1) / span;
  }

  fs::path path_;
  RecordingRequest request_;
  std::unique_ptr<MessageStream> stream_;
  Source imu_{{"imu", kImuType, {}}};
  Source radar_{{"radar", kCloudType, {}}};
  Source trigger_{{"trigger", kHeaderType, {}}};
  std::vector<std::vector<Source*>> uses_;  ///< of each topic
  CloudReader clouds_;
  RadarScan scan_;
  io::DopplerGrid grid_;
  std::vector<std::string> notes_;
  std::exception_ptr failed_;
  Surveyed out_;
};

}  // namespace

ImuSample imu_sample(const Topic& topic, const Message& message, const RecordingRequest& request,
                     Header* header) {
  ImuSample sample = decode_imu(topic.encoding, message.data, header);
  sample.gyro_B *= request.gyro_unit;
  sample.accel_B *= request.accel_unit;
  return sample;
}

void CloudReader::read(const Topic& topic, const Message& message, Header* header,
                       std::vector<RadarDetection>* detections, std::vector<std::string>* notes) {
  detections->clear();
  const PointCloud cloud = decode_cloud_of(topic, message.data);
  *header = cloud.header;
  if (cloud.size() == 0) return;
  if (!map_ || map_->fields() != cloud.fields) {
    map_.emplace(cloud.fields, request_);
    if (notes != nullptr) notes->push_back("points, " + map_->text());
  }
  points_left_out_ += map_->convert(cloud, detections);
}

Surveyed survey(const fs::path& path, const RecordingRequest& request) {
  return Survey(path, request).run();
}

}  // namespace rio::bag

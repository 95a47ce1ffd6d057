// SPDX-License-Identifier: BSD-3-Clause
#include "recording_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <exception>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "frames.hpp"
#include "io/doppler_grid.hpp"
#include "rio/bag/summary.hpp"
#include "trigger.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

/// A topic that may have a role, while it is read.
struct Source {
  Role role;
  Stamps stamps{};
  std::string type{};   ///< of its messages
  std::string frame{};  ///< of the first message
  std::size_t unreadable = 0;
  std::string first_error{};
  // of an IMU
  std::size_t without_gyro = 0;  ///< messages
  std::size_t without_accel = 0;
  std::size_t absent = 0;  ///< messages that say that they have no values
  std::size_t denied = 0;  ///< the same, but have some
  // of a radar
  std::optional<CloudReader> clouds{};
  io::DopplerGrid grid{};
  std::vector<std::string> notes{};
  std::exception_ptr failed{};
  // of a barometer, of the ground truth
  std::vector<io::BaroSample> baro{};
  std::vector<NavState> truth{};
  bool has_velocity = true;

  bool only_gyro() const { return without_accel == stamps.count && without_gyro < stamps.count; }
  bool only_accel() const { return without_gyro == stamps.count && without_accel < stamps.count; }
};

std::string topic_list(const Summary& summary) {
  std::string text;
  for (const TopicSummary& s : summary.topics) {
    text += fmt::format("\n  {} {} ({} messages)", s.topic.name, s.topic.type, s.messages);
  }
  return text.empty() ? "\n  none" : text;
}

std::vector<std::string> names_in(const std::string& list) {
  std::istringstream text(list);
  std::vector<std::string> names;
  for (std::string name; std::getline(text, name, ',');) names.push_back(name);
  return names.empty() ? std::vector<std::string>{""} : names;
}

class Survey {
 public:
  Survey(const fs::path& path, const RecordingRequest& request)
      : path_(path), request_(request), stream_(open_messages(path)) {
    want("imu", kImuType, request.imu_topic);
    want("radar", kCloudType, request.radar_topic);
    if (request.radar_clock == Clock::kTrigger) {
      want("trigger", kHeaderType, request.trigger_topic);
    }
    want("baro", kPressureType, request.baro_topic);
    if (request.truth) want("truth", kPoseType, request.truth_topic);
    if (request.imu_clock == Clock::kTrigger) {
      throw std::runtime_error("the clock \"trigger\" is for the radar alone");
    }
  }

  Surveyed run() {
    summary_ = summarise(stream_.get(), [this](const Message& message) { use(message); });
    choose_imu();
    choose_radars();
    if (request_.radar_clock == Clock::kTrigger) {
      trigger_ = only(found("trigger", request_.trigger_topic));
    }
    baro_ = choose_optional("baro", request_.baro_topic);
    if (request_.truth) truth_ = choose_optional("truth", request_.truth_topic);
    for (const Source* radar : radars_) {
      if (radar->failed) std::rethrow_exception(radar->failed);
    }
    for (const Source* source : used()) require_some(*source);
    put_on_one_clock();
    tell();
    out_.outline.damage = stream_->damage();
    return std::move(out_);
  }

 private:
  void want(const char* role, const char* type, const std::string& names) {
    for (const std::string& name : names_in(names)) wanted_.push_back({role, type, name});
  }

  /// All topics with a role in the result.
  std::vector<Source*> used() const {
    std::vector<Source*> all = {imu_};
    for (Source* source : {accel_, trigger_, baro_, truth_}) {
      if (source != nullptr) all.push_back(source);
    }
    all.insert(all.begin() + 1, radars_.begin(), radars_.end());
    return all;
  }

  void note(std::string text) { notes_.push_back(std::move(text)); }

  /// For each possible source; the choice is made at the end.
  void use(const Message& message) {
    while (uses_.size() < stream_->topics().size()) {
      const Topic& topic = stream_->topics()[uses_.size()];
      uses_.emplace_back();
      for (const Role& role : wanted_) {
        // --imu may name one half of an IMU
        const bool half = role.type == kImuType && Role{"", kImuType, ""}.fits(topic);
        if (!role.fits(topic) && !half) continue;
        const auto known = std::find_if(sources_.begin(), sources_.end(), [&](const Source& s) {
          return s.role.role == std::string(role.role) && s.role.name == topic.name;
        });
        Source* source = known == sources_.end() ? nullptr : &*known;
        if (source == nullptr) {
          source = &sources_.emplace_back(Source{{role.role, role.type, topic.name}});
          source->type = topic.type;
          source->clouds.emplace(request_.points);
        }
        if (std::count(uses_.back().begin(), uses_.back().end(), source) == 0) {
          uses_.back().push_back(source);
        }
      }
    }
    const Topic& topic = stream_->topics()[message.topic];
    if (is_transforms(topic) && topic.encoding != Encoding::kOther) {
      try {
        frames_.add(decode_transforms(topic.encoding, message.data));
      } catch (const Damage&) {  // as if there were none
      }
    }
    for (Source* source : uses_[message.topic]) {
      if (!source->failed) decode(source, topic, message);
    }
  }

  void decode(Source* source, const Topic& topic, const Message& message) {
    const std::string& type = source->role.type;
    try {
      Header header;
      if (type == kImuType) {
        const ImuMessage read = imu_message(topic, message, request_);
        header = read.header;
        source->without_gyro += read.gyro ? 0 : 1;
        source->without_accel += read.accel ? 0 : 1;
        source->absent += read.absent ? 1 : 0;
        source->denied += read.denied ? 1 : 0;
      } else if (type == kPressureType) {
        const double pressure = decode_pressure(topic.encoding, message.data, &header);
        source->baro.push_back({Time(0), pressure});
      } else if (type == kPoseType) {
        source->truth.push_back(decode_truth(topic, message.data, &header, &source->has_velocity));
      } else if (type == kCloudType) {
        source->clouds->read(topic, message, &header, &scan_.detections, &source->notes);
        source->grid.add(scan_);
      } else {
        header = decode_header(topic.encoding, message.data);
      }
      if (source->stamps.count == 0) source->frame = header.frame_id;
      source->stamps.add(header, message.received, type != kImuType);
    } catch (const Damage& damage) {
      if (source->unreadable++ == 0) {
        source->first_error = fmt::format("byte {}: {}", damage.offset, damage.what());
      }
    } catch (const std::runtime_error&) {
      source->failed = std::current_exception();
    }
  }

  /// The sources of a role with messages: those requested, in this order, or all of its type.
  std::vector<Source*> found(const std::string& role, const std::string& names) {
    std::vector<Source*> out;
    for (const std::string& name : names_in(names)) {
      const std::size_t before = out.size();
      std::string wrong_type;  // of the requested topic
      for (const TopicSummary& s : summary_.topics) {
        if (s.topic.name == name) wrong_type = s.topic.type;
      }
      for (Source& source : sources_) {
        if (source.role.role != role || (!name.empty() && source.role.name != name)) continue;
        if (source.stamps.count + source.unreadable > 0 || source.failed) out.push_back(&source);
      }
      if (out.size() > before) continue;
      const auto asked = std::find_if(wanted_.begin(), wanted_.end(),
                                      [&](const Role& r) { return r.role == role; });
      if (!wrong_type.empty()) {
        throw std::runtime_error(fmt::format("{}: topic {} is of type {}; read is {}",
                                             path_.string(), name, wrong_type, asked->type));
      }
      throw std::runtime_error(fmt::format("{}: no topic {}; there are{}{}", path_.string(),
                                           name.empty() ? "of type " + asked->type : name,
                                           topic_list(summary_),
                                           summary_.damage.empty() ? "" : "\n" + summary_.damage));
    }
    return out;
  }

  [[noreturn]] void fail_ambiguous(const Source& one) const {
    throw std::runtime_error(fmt::format("{}: several topics of type {}; choose with --{}:{}",
                                         path_.string(), one.role.type, one.role.role,
                                         topic_list(summary_)));
  }

  Source* only(const std::vector<Source*>& sources) const {
    if (sources.size() > 1) fail_ambiguous(*sources[0]);
    return sources[0];
  }

  /// Null if there is none, or several of which none is requested.
  Source* choose_optional(const std::string& role, const std::string& name) {
    if (!name.empty()) return only(found(role, name));
    Source* one = nullptr;
    std::size_t count = 0;
    for (Source& source : sources_) {
      if (source.role.role != role || source.stamps.count == 0) continue;
      one = &source;
      ++count;
    }
    if (count > 1)
      note(fmt::format("several topics may be the {}: none is used; --{}", role, role));
    return count == 1 ? one : nullptr;
  }

  /// The only IMU; or gyroscope and accelerometer, if they are on two topics.
  void choose_imu() {
    std::vector<Source*> whole = found("imu", request_.imu_topic);
    std::vector<Source*> all = found("imu", "");
    std::vector<Source*> gyros;
    std::vector<Source*> accels;
    const auto sort_out = [&](const std::vector<Source*>& from) {
      for (Source* source : from) {
        if (source->only_gyro()) gyros.push_back(source);
        if (source->only_accel()) accels.push_back(source);
      }
    };
    const auto is_half = [](const Source* s) { return s->only_gyro() || s->only_accel(); };
    sort_out(whole);
    if (!std::all_of(whole.begin(), whole.end(), is_half)) {
      if (request_.imu_topic.empty()) std::erase_if(whole, is_half);
      imu_ = only(whole);
      return;
    }
    if (gyros.empty() || accels.empty()) {  // the other half
      gyros.clear();
      accels.clear();
      sort_out(all);
      const bool of_gyro = whole[0]->only_gyro();
      if (whole.size() == 1) (of_gyro ? gyros : accels) = whole;
    }
    if (gyros.empty() || accels.empty()) {
      throw std::runtime_error(fmt::format("{}: {} has no {}, and no other topic has it",
                                           path_.string(), whole[0]->role.name,
                                           gyros.empty() ? "gyroscope" : "accelerometer"));
    }
    imu_ = only(gyros);
    accel_ = only(accels);
    note(fmt::format("the IMU is on two topics: gyroscope {}, accelerometer {} at its stamps",
                     imu_->role.name, accel_->role.name));
  }

  /// The requested ones, or the only one, or all of which /tf_static knows the mounting.
  void choose_radars() {
    radars_ = found("radar", request_.radar_topic);
    if (!request_.radar_topic.empty()) return check_number_of_radars();
    const auto failed = [](const Source* s) { return s->failed != nullptr; };
    if (radars_.size() > 1 && !std::all_of(radars_.begin(), radars_.end(), failed)) {
      std::erase_if(radars_, failed);  // clouds without Doppler
    }
    if (radars_.size() == 1) return;
    std::vector<std::string> frames;
    for (const Source* radar : radars_) {
      const bool same = std::count(frames.begin(), frames.end(), radar->frame) > 0;
      if (same || !frames_.pose(radar->frame, imu_->frame)) fail_ambiguous(*radar);
      frames.push_back(radar->frame);
    }
    std::sort(radars_.begin(), radars_.end(),
              [](const Source* a, const Source* b) { return a->role.name < b->role.name; });
    check_number_of_radars();
  }

  void check_number_of_radars() const {
    if (radars_.size() <= 1 + Options::kMaxOtherRadars) return;
    throw std::runtime_error(fmt::format("{}: {} radars, at most {} are used; choose with --radar",
                                         path_.string(), radars_.size(),
                                         1 + Options::kMaxOtherRadars));
  }

  void require_some(const Source& source) const {
    if (source.stamps.count > source.absent) return;
    const std::string error =
        source.first_error.empty() ? "" : "; the first one, " + source.first_error;
    throw std::runtime_error(fmt::format(
        "{}: no readable message on {}{}{}{}", path_.string(), source.role.name, error,
        source.absent > 0 ? "; they say that they have no gyroscope or no accelerometer" : "",
        stream_->damage().empty() ? "" : "; " + stream_->damage()));
  }

  void put_on_one_clock() {
    Clock imu = request_.imu_clock;
    Clock radar = request_.radar_clock;
    std::vector<Source*> others = radars_;
    if (trigger_ != nullptr) others = {trigger_};
    bool headers = imu_->stamps.zeros == 0;
    double apart = 0.0;
    for (Source* other : others) {
      headers = headers && other->stamps.zeros == 0;
      const double delay = to_seconds(imu_->stamps.delay()) - to_seconds(other->stamps.delay());
      apart = std::max(apart, std::abs(delay));
    }
    if (imu == Clock::kAuto && radar == Clock::kAuto && headers && apart < 1.0) {
      imu = radar = Clock::kHeader;
    }
    const bool stamped = radar == Clock::kHeader || radar == Clock::kTrigger;
    if (imu == Clock::kAuto && stamped) imu = Clock::kHeader;
    if (radar == Clock::kAuto && imu == Clock::kHeader) radar = Clock::kHeader;
    if (headers && apart >= 1.0) {
      note(fmt::format("the header clocks of IMU and {} are {:.3f} s apart", others[0]->role.role,
                       apart));
    }
    out_.imu = stamp_imu(imu_, imu);
    if (accel_ != nullptr) out_.accel = stamp_imu(accel_, imu);
    io::RecordingOutline& outline = out_.outline;
    const Stamps& stamps = imu_->stamps;
    const auto at = [&](const Header& head, Time received, std::size_t i) {
      return (out_.imu.received ? received : head.stamp + out_.imu.shifts.at(i)) + out_.imu.shift;
    };
    outline.imu_samples = stamps.count - (accel_ == nullptr ? imu_->absent : 0);
    outline.imu_begin = at(stamps.first, stamps.first_received, 0);
    outline.imu_end = at(stamps.last, stamps.last_received, stamps.count - 1);
    for (Source* source : radars_) {
      Surveyed::Radar& of = out_.radars.emplace_back();
      of.role = source->role;
      std::vector<Time> times;
      if (radar == Clock::kTrigger) {
        stamp_by_triggers(*source, &of, &times);
      } else {
        times = stamp_all(source, radar, request_.radar_offset);
        of.kept.assign(times.size(), true);
      }
      leave_out_repeated(&of, &times);
      outline.scan_times.push_back(std::move(times));
    }
    take_others(imu == Clock::kHeader ? Clock::kHeader : Clock::kAuto);
  }

  /// Barometer and ground truth.
  void take_others(Clock clock) {
    if (baro_ != nullptr) {
      const std::vector<Time> times = stamp_all(baro_, clock, request_.imu_offset);
      for (std::size_t i = 0; i < times.size(); ++i) baro_->baro[i].time = times[i];
      out_.baro = std::move(baro_->baro);
      out_.outline.baro_samples = out_.baro.size();
    }
    if (truth_ == nullptr) return;
    const std::vector<Time> times = stamp_all(truth_, clock, request_.imu_offset);
    std::vector<NavState>& states = out_.outline.sensors.ground_truth;
    for (std::size_t i = 0; i < times.size(); ++i) {
      truth_->truth[i].time = times[i];
      if (states.empty() || times[i] > states.back().time) states.push_back(truth_->truth[i]);
    }
    if (truth_->has_velocity) return;
    for (std::size_t i = 0; i < states.size() && states.size() > 1; ++i) {
      const NavState& a = states[i == 0 ? 0 : i - 1];
      const NavState& b = states[std::min(i + 1, states.size() - 1)];
      states[i].v_WB = (b.p_WB - a.p_WB) / to_seconds(b.time - a.time);
    }
  }

  void leave_out_repeated(Surveyed::Radar* radar, std::vector<Time>* times) {
    std::size_t count = 0;  // of the kept ones
    for (std::size_t i = 0, k = 0; i < radar->kept.size(); ++i) {
      if (!radar->kept[i]) continue;
      const Time time = (*times)[k++];
      if (count > 0 && (*times)[count - 1] == time) {
        radar->kept[i] = false;
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
  void stamp_by_triggers(const Source& radar, Surveyed::Radar* of, std::vector<Time>* times) {
    const std::vector<std::uint32_t>& numbers = trigger_->stamps.sequence;
    const bool counted = std::any_of(numbers.begin(), numbers.end(), [](auto n) { return n > 0; });
    const std::string& name = trigger_->role.name;
    if (request_.trigger_match == TriggerMatch::kSequence && !counted) {
      throw std::runtime_error(path_.string() + ": messages on " + name +
                               " have no sequence numbers, as in ROS 2; match \"earlier\" does "
                               "without");
    }
    require_no_zero(*trigger_);
    Triggers triggers(request_.trigger_match);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      triggers.add(numbers[i], trigger_->stamps.header[i], trigger_->stamps.received[i]);
    }
    triggers.sort();
    const std::size_t all = radar.stamps.count;
    for (std::size_t i = 0; i < all; ++i) {
      const auto time = triggers.find(radar.stamps.sequence[i], radar.stamps.received[i]);
      of->kept.push_back(time.has_value());
      if (time) times->push_back(*time + from_seconds(request_.radar_offset));
    }
    if (times->empty()) {
      throw std::runtime_error(fmt::format("{}: no scan on {} has a trigger on {}", path_.string(),
                                           radar.role.name, name));
    }
    note(
        fmt::format("{}: {} messages, {} stamped by the last trigger before on {}{}{}; {} without "
                    "one are left out",
                    radar.role.name, all, times->size(), name,
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
        source.stamps.count, source.role.name,
        &source == trigger_ ? "" : fmt::format("; use --{}-clock receive", source.role.role)));
  }

  Surveyed::Imu stamp_imu(Source* source, Clock clock) {
    Surveyed::Imu out;
    out.role = source->role;
    out.shifts = source->stamps.shifts();
    std::tie(out.received, out.shift) = decide(source, clock, request_.imu_offset);
    return out;
  }

  std::vector<Time> stamp_all(Source* source, Clock clock, double offset) {
    const auto [received, shift] = decide(source, clock, offset);
    const Shifts shifts = source->stamps.shifts();
    std::vector<Time> times = received ? source->stamps.received : source->stamps.header;
    for (std::size_t i = 0; i < times.size(); ++i) {
      times[i] += shift + (received ? Time(0) : shifts.at(i));
    }
    return times;
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
    note(fmt::format("{}: {} messages, {}", source->role.name, stamps.count, text));
    if (clock != Clock::kReceive) {
      const Shifts shifts = stamps.shifts();
      for (const Shifts::Jump& jump : shifts.jumps()) {
        note(fmt::format(
            "{}: the header clock jumps by {:+.3f} s at message {}; later stamps are "
            "moved by {:+.6f} s: it goes on as the messages were received",
            source->role.name, to_seconds(jump.by), jump.message + 1, to_seconds(jump.added)));
      }
    }
    if (clock != Clock::kHeader && source->role.type == kCloudType && offset == 0.0) {
      note("scans arrive later than they were measured: --radar-offset, below zero");
    }
    return {clock == Clock::kReceive, delay + from_seconds(offset)};
  }

  /// The mounting that /tf_static tells.
  std::optional<Pose> mounting(const Source& radar) const {
    std::optional<Pose> T = frames_.pose(radar.frame, imu_->frame);
    if (T && radar.clouds->map() != nullptr) {
      T->rotation = T->rotation * Quaternion(radar.clouds->map()->rotation().transpose());
    }
    return radar.frame == imu_->frame ? std::nullopt : T;
  }

  /// Sensor properties, and notes on missing sensor files and dropped data.
  void tell() {
    io::RecordingOutline& outline = out_.outline;
    outline.sensors.imu_info.rate_hz =
        rate(outline.imu_begin, outline.imu_end, outline.imu_samples);
    for (std::size_t r = 0; r < radars_.size(); ++r) {
      Source& source = *radars_[r];
      io::RadarInfo& info =
          r == 0 ? outline.sensors.radar_info : outline.sensors.other_radars.emplace_back().info;
      const std::vector<Time>& times = outline.scan_times[r];
      info.rate_hz = rate(times.front(), times.back(), times.size());
      for (std::string& text : source.notes) {
        note(radars_.size() > 1 ? source.role.name + ": " + text : std::move(text));
      }
      info.T_BS = mounting(source);
      if (info.T_BS) note(mounting_text(source.role.name, *info.T_BS));
      info.doppler_resolution = doppler_grid(r);
      if (info.doppler_resolution) {
        note(fmt::format("the Doppler has steps of {:.4f} m/s", *info.doppler_resolution));
      }
      if (source.clouds->map() != nullptr) source.clouds->map()->name(&info);
      if (source.clouds->points_left_out() > 0) {
        note(fmt::format("{} points are not finite and are left out",
                         source.clouds->points_left_out()));
      }
    }
    if (!request_.mounting_is_known && !outline.sensors.radar_info.T_BS) {
      note(
          "no mounting in a recording: radar pose from the options, by default at the body origin");
    }
    if (imu_->type == kPx4ImuType) {
      note(imu_->role.name + ": axes forward, right, down, turned to forward, left, up");
    }
    if (imu_->denied > 0) {
      note(
          fmt::format("{}: {} messages have values and a covariance of -1, which says that they "
                      "have none: the values are used",
                      imu_->role.name, imu_->denied));
    }
    for (const Source* source : used()) {
      const std::size_t absent = accel_ == nullptr ? source->absent : 0;
      if (source->unreadable + absent == 0) continue;
      note(fmt::format("{}: {} messages cannot be read and are left out; the first one, {}",
                       source->role.name, source->unreadable + absent,
                       source->unreadable > 0 ? source->first_error
                                              : "says that it has no gyroscope or accelerometer"));
    }
    outline.sensors.notes = std::move(notes_);
  }

  static std::string mounting_text(const std::string& name, const Pose& T) {
    const Vector3d& p = T.translation;
    const Quaternion& q = T.rotation;
    return fmt::format(
        "{}: mounting of /tf_static: T_BS: {{translation: [{:.4f}, {:.4f}, {:.4f}], "
        "quaternion_wxyz: [{:.6f}, {:.6f}, {:.6f}, {:.6f}]}}",
        name, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
  }

  /// Of the scans of the outline.
  std::optional<double> doppler_grid(std::size_t r) {
    const Surveyed::Radar& radar = out_.radars[r];
    const auto each_scan = [&](const auto& use) {
      const std::unique_ptr<MessageStream> stream = open_messages(path_);
      CloudReader clouds(request_.points);
      Message message;
      Header header;
      RadarScan scan;
      bool go_on = true;
      for (std::size_t i = 0; go_on && i < radar.kept.size() && stream->next(&message);) {
        const Topic& topic = stream->topics()[message.topic];
        if (!radar.role.fits(topic)) continue;
        try {
          clouds.read(topic, message, &header, &scan.detections, nullptr);
        } catch (const Damage&) {
          continue;
        }
        if (radar.kept[i++]) go_on = use(scan);
      }
    };
    if (out_.outline.scan_times[r].size() == radar.kept.size()) {
      return radars_[r]->grid.step(each_scan);
    }
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
  std::vector<Role> wanted_;
  std::deque<Source> sources_;
  std::vector<std::vector<Source*>> uses_;  ///< of each topic
  Summary summary_;
  Frames frames_;
  Source* imu_ = nullptr;    ///< or its gyroscope
  Source* accel_ = nullptr;  ///< if on another topic
  std::vector<Source*> radars_;
  Source* trigger_ = nullptr;
  Source* baro_ = nullptr;
  Source* truth_ = nullptr;
  RadarScan scan_;
  std::vector<std::string> notes_;
  Surveyed out_;
};

}  // namespace

ImuMessage imu_message(const Topic& topic, const Message& message,
                       const RecordingRequest& request) {
  ImuMessage read = decode_imu_of(topic, message.data);
  read.sample.gyro_B *= request.gyro_unit;
  read.sample.accel_B *= request.accel_unit;
  return read;
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

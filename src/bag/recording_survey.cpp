// SPDX-License-Identifier: BSD-3-Clause
#include "recording_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "io/doppler_grid.hpp"
#include "recording_sources.hpp"
#include "trigger.hpp"

namespace rio::bag {

namespace fs = std::filesystem;

namespace {

class Survey {
 public:
  Survey(const fs::path& path, const RecordingRequest& request)
      : path_(path), request_(request), sources_(path, request) {
    if (request.imu_clock == Clock::kTrigger) {
      throw std::runtime_error("the clock \"trigger\" is for the radar alone");
    }
  }

  Surveyed run() {
    sources_.choose();
    notes_ = sources_.notes;
    for (const Source* source : sources_.used()) require_some(*source);
    put_on_one_clock();
    tell_pauses();
    tell_ends();
    tell();
    out_.outline.damage = sources_.damage();
    return std::move(out_);
  }

 private:
  void note(std::string text) { notes_.push_back(std::move(text)); }

  void require_some(const Source& source) const {
    if (source.stamps.count > source.absent) return;
    const std::string error =
        source.first_error.empty() ? "" : "; the first one, " + source.first_error;
    throw std::runtime_error(fmt::format(
        "{}: no readable message on {}{}{}{}", path_.string(), source.role.name, error,
        source.absent > 0 ? "; they say that they have no gyroscope or no accelerometer" : "",
        sources_.damage().empty() ? "" : "; " + sources_.damage()));
  }

  /// The first one whose headers are not on the clock of the IMU, with a note; null if all are.
  const Source* on_another_clock(const std::vector<Source*>& others) {
    constexpr double kLate = 10.0;  // [s] a topic may be: not much for two clocks
    Stamps& imu = sources_.imu->stamps;
    const auto other = std::find_if(others.begin(), others.end(), [&](const Source* source) {
      return !source->stamps.is_on_clock_of(imu);
    });
    if (other == others.end()) return nullptr;
    const double apart = std::abs(to_seconds((*other)->stamps.delay()) - to_seconds(imu.delay()));
    const bool is_accel = *other == sources_.accel;
    const bool by_default =
        request_.imu_clock == Clock::kAuto && request_.radar_clock == Clock::kAuto;
    note(fmt::format("the header clocks of IMU and {} are {:.3f} s apart{}",
                     is_accel ? "accelerometer" : (*other)->role.role, apart,
                     by_default && apart < kLate ? "; if one only arrives late: --imu-clock header "
                                                   "--radar-clock header"
                                                 : ""));
    return *other;
  }

  void put_on_one_clock() {
    Clock imu = request_.imu_clock;
    Clock radar = request_.radar_clock;
    std::vector<Source*> others = sources_.radars;
    if (sources_.trigger != nullptr) others = {sources_.trigger};
    if (sources_.accel != nullptr) others.push_back(sources_.accel);
    bool headers = sources_.imu->stamps.zeros == 0;
    for (const Source* other : others) headers = headers && other->stamps.zeros == 0;
    const Source* const apart = headers ? on_another_clock(others) : nullptr;
    if (imu == Clock::kAuto && radar == Clock::kAuto && headers && apart == nullptr) {
      imu = radar = Clock::kHeader;
    }
    const bool stamped = radar == Clock::kHeader || radar == Clock::kTrigger;
    if (imu == Clock::kAuto && stamped) imu = Clock::kHeader;
    if (radar == Clock::kAuto && imu == Clock::kHeader) radar = Clock::kHeader;
    out_.imu = stamp_imu(sources_.imu, imu);
    if (sources_.accel != nullptr) out_.accel = stamp_imu(sources_.accel, imu);
    io::RecordingOutline& outline = out_.outline;
    const Stamps& stamps = sources_.imu->stamps;
    const auto at = [&](const Header& head, Time received, std::size_t i) {
      return (out_.imu.received ? received : head.stamp + out_.imu.shifts.at(i)) + out_.imu.shift;
    };
    outline.imu_samples = stamps.count - (sources_.accel == nullptr ? sources_.imu->absent : 0);
    outline.imu_begin = at(stamps.first, stamps.first_received, 0);
    outline.imu_end = at(stamps.last, stamps.last_received, stamps.count - 1);
    for (Source* source : sources_.radars) {
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
    take_others(imu == Clock::kHeader);
  }

  /// Barometer and ground truth, on the clock of the IMU.
  void take_others(bool by_headers) {
    if (sources_.baro != nullptr) {
      const std::vector<Time> times = stamp_other(sources_.baro, by_headers);
      for (std::size_t i = 0; i < times.size(); ++i) sources_.baro->baro[i].time = times[i];
      out_.baro = std::move(sources_.baro->baro);
      out_.outline.baro_samples = out_.baro.size();
    }
    if (sources_.truth == nullptr) return;
    const std::vector<Time> times = stamp_other(sources_.truth, by_headers);
    std::vector<NavState>& states = out_.outline.sensors.ground_truth;
    for (std::size_t i = 0; i < times.size(); ++i) {
      sources_.truth->truth[i].time = times[i];
      if (states.empty() || times[i] > states.back().time)
        states.push_back(sources_.truth->truth[i]);
    }
    if (sources_.truth->has_velocity) return;
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
    const std::vector<std::uint32_t>& numbers = sources_.trigger->stamps.sequence;
    const bool counted = std::any_of(numbers.begin(), numbers.end(), [](auto n) { return n > 0; });
    const std::string& name = sources_.trigger->role.name;
    if (request_.trigger_match == TriggerMatch::kSequence && !counted) {
      throw std::runtime_error(path_.string() + ": messages on " + name +
                               " have no sequence numbers, as in ROS 2; match \"earlier\" does "
                               "without");
    }
    require_no_zero(*sources_.trigger);
    Triggers triggers(request_.trigger_match);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      triggers.add(numbers[i], sources_.trigger->stamps.header[i],
                   sources_.trigger->stamps.received[i]);
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
        &source == sources_.trigger ? ""
                                    : fmt::format("; use --{}-clock receive", source.role.role)));
  }

  Surveyed::Imu stamp_imu(Source* source, Clock clock) {
    Surveyed::Imu out;
    out.role = source->role;
    out.shifts = source->stamps.shifts();
    std::tie(out.received, out.shift) = decide(source, clock, request_.imu_offset);
    const Stamps& stamps = source->stamps;
    const auto intervals = static_cast<std::int64_t>(std::max<std::size_t>(stamps.count, 2) - 1);
    out.interval = (stamps.last_received - stamps.first_received) / intervals;
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

  /// @param by_headers as the IMU is; a topic on another clock, or without stamps, is put there by
  /// its receive times
  std::vector<Time> stamp_other(Source* source, bool by_headers) {
    Stamps& imu = sources_.imu->stamps;
    const Stamps& of = source->stamps;
    const bool same = of.zeros == 0 && (of.is_on_clock_of(imu) || !of.is_recorded_with(imu));
    if (!by_headers) return stamp_all(source, Clock::kAuto, request_.imu_offset);
    if (same) return stamp_all(source, Clock::kHeader, request_.imu_offset);
    return stamp_all(source, Clock::kAuto, request_.imu_offset - to_seconds(imu.delay()));
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
    std::optional<Pose> T = sources_.frames.pose(radar.frame, sources_.imu->frame);
    if (T) {
      T->translation = to_flu(request_.imu_axes, T->translation);
      T->rotation = Quaternion(flu_from(request_.imu_axes)) * T->rotation;
    }
    if (T && radar.clouds->map() != nullptr) {
      T->rotation = T->rotation * Quaternion(radar.clouds->map()->rotation().transpose());
    }
    return radar.frame == sources_.imu->frame ? std::nullopt : T;
  }

  /// Pauses of the IMU and of all radars.
  void tell_pauses() {
    const Stamps& imu = sources_.imu->stamps;
    std::vector<const Stamps*> radars;
    for (const Source* radar : sources_.radars) radars.push_back(&radar->stamps);
    for (const Stamps::Pause& pause : imu.common_pauses(radars)) {
      note(fmt::format(
          "clock set forward by {:.1f} s, or the recorder paused, {:.1f} s after the "
          "begin: the flight behind needs a recording of its own",
          to_seconds(pause.length), to_seconds(pause.end - pause.length - imu.first_received)));
    }
  }

  /// Radars that end before the IMU.
  void tell_ends() {
    constexpr double kEarly = 1.0;  // [s] some scans
    for (std::size_t r = 0; r < sources_.radars.size(); ++r) {
      // not of the difference, which may overflow
      const double ahead =
          to_seconds(out_.outline.imu_end) - to_seconds(out_.outline.scan_times[r].back());
      if (ahead < kEarly) continue;
      note(fmt::format("{} ends {:.1f} s before {}", sources_.radars[r]->role.name, ahead,
                       sources_.imu->role.name));
    }
  }

  /// Sensor properties, and notes on missing sensor files and dropped data.
  void tell() {
    io::RecordingOutline& outline = out_.outline;
    outline.sensors.imu_info.rate_hz =
        rate(outline.imu_begin, outline.imu_end, outline.imu_samples);
    for (std::size_t r = 0; r < sources_.radars.size(); ++r) {
      Source& source = *sources_.radars[r];
      io::RadarInfo& info =
          r == 0 ? outline.sensors.radar_info : outline.sensors.other_radars.emplace_back().info;
      const std::vector<Time>& times = outline.scan_times[r];
      info.rate_hz = rate(times.front(), times.back(), times.size());
      for (std::string& text : source.notes) {
        note(sources_.radars.size() > 1 ? source.role.name + ": " + text : std::move(text));
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
    if (request_.imu_axes != Axes::kFlu) {
      note(fmt::format("{}: axes {}, turned to forward, left, up", sources_.imu->role.name,
                       names_of(request_.imu_axes)[static_cast<std::size_t>(request_.imu_axes)]));
    }
    if (sources_.imu->type == kPx4ImuType) {
      note(sources_.imu->role.name + ": axes forward, right, down, turned to forward, left, up");
    }
    if (sources_.imu->denied > 0) {
      note(
          fmt::format("{}: {} messages have values and a covariance of -1, which says that they "
                      "have none: the values are used",
                      sources_.imu->role.name, sources_.imu->denied));
    }
    for (const Source* source : sources_.used()) {
      const std::size_t absent = sources_.accel == nullptr ? source->absent : 0;
      if (source->unreadable + absent == 0) continue;
      note(left_out_text(source->role.name, source->unreadable + absent,
                         source->unreadable > 0
                             ? source->first_error
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
      return sources_.radars[r]->grid.step(each_scan);
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
  Sources sources_;
  std::vector<std::string> notes_;
  Surveyed out_;
};

}  // namespace

Surveyed survey(const fs::path& path, const RecordingRequest& request) {
  return Survey(path, request).run();
}

}  // namespace rio::bag

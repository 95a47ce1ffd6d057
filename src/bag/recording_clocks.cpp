// SPDX-License-Identifier: BSD-3-Clause
// The stamps of IMU, radars, barometer and truth, by headers, receive times or triggers, on one
// clock; each with a note of what was done.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "recording_sources.hpp"

namespace rio::bag {

namespace {

class OneClock {
 public:
  OneClock(Sources* sources, Surveyed* out)
      : sources_(sources), request_(sources->request()), out_(out) {}

  void run() {
    Clock imu = request_.imu_clock;
    Clock radar = request_.radar_clock;
    std::vector<Source*> others = sources_->radars;
    if (sources_->trigger != nullptr) others = {sources_->trigger};
    if (sources_->accel != nullptr) others.push_back(sources_->accel);
    bool headers = sources_->imu->stamps.has_times();
    for (const Source* other : others) headers = headers && other->stamps.has_times();
    const Source* const apart = headers ? on_another_clock(others) : nullptr;
    if (imu == Clock::kAuto && radar == Clock::kAuto && headers && apart == nullptr) {
      imu = radar = Clock::kHeader;
    }
    const bool stamped = radar == Clock::kHeader || radar == Clock::kTrigger;
    if (imu == Clock::kAuto && stamped) imu = Clock::kHeader;
    if (radar == Clock::kAuto && imu == Clock::kHeader) radar = Clock::kHeader;
    out_->imu = stamp_imu(sources_->imu, imu);
    if (sources_->accel != nullptr) out_->accel = stamp_imu(sources_->accel, imu);
    io::RecordingOutline& outline = out_->outline;
    const Stamps& stamps = sources_->imu->stamps;
    const Stamping& how = out_->imu.stamping;
    outline.imu_samples = stamps.count - (sources_->accel == nullptr ? sources_->imu->absent : 0);
    outline.imu_odd = stamps.backs > 0;
    outline.imu_begin = how.stamp(stamps.first.stamp, stamps.first_received, 0);
    outline.imu_end = how.stamp(stamps.last.stamp, stamps.last_received, stamps.count - 1);
    for (Source* source : sources_->radars) {
      if (radar == Clock::kTrigger) {
        keep(*source, stamp_by_triggers(*source));
      } else {
        const std::vector<Time> times = stamp_all(source, radar, request_.radar_offset);
        keep(*source, {times.begin(), times.end()});
      }
    }
    take_others(imu == Clock::kHeader);
  }

 private:
  /// The first one whose headers are not on the clock of the IMU, with a note; null if all are.
  const Source* on_another_clock(const std::vector<Source*>& others) {
    constexpr double kLate = 10.0;  // [s] a topic may be: not much for two clocks
    Stamps& imu = sources_->imu->stamps;
    const auto other = std::find_if(others.begin(), others.end(), [&](const Source* source) {
      return !source->stamps.is_on_clock_of(imu);
    });
    if (other == others.end()) return nullptr;
    const double apart = std::abs(to_seconds((*other)->stamps.delay()) - to_seconds(imu.delay()));
    const bool is_accel = *other == sources_->accel;
    const bool by_default =
        request_.imu_clock == Clock::kAuto && request_.radar_clock == Clock::kAuto;
    sources_->note("the header clocks of IMU and {} are {:.3f} s apart{}",
                   is_accel ? "accelerometer" : (*other)->role.role, apart,
                   by_default && apart < kLate ? "; if one only arrives late: --imu-clock header "
                                                 "--radar-clock header"
                                               : "");
    return *other;
  }

  /// Barometer and ground truth, on the clock of the IMU.
  void take_others(bool by_headers) {
    if (sources_->baro != nullptr) {
      const std::vector<Time> times = stamp_other(sources_->baro, by_headers);
      for (std::size_t i = 0; i < times.size(); ++i) sources_->baro->baro[i].time = times[i];
      out_->baro = std::move(sources_->baro->baro);
      out_->outline.baro_samples = out_->baro.size();
    }
    if (sources_->truth == nullptr) return;
    const std::vector<Time> times = stamp_other(sources_->truth, by_headers);
    std::vector<NavState>& states = out_->outline.sensors.ground_truth;
    for (std::size_t i = 0; i < times.size(); ++i) {
      sources_->truth->truth[i].time = times[i];
      if (states.empty() || times[i] > states.back().time)
        states.push_back(sources_->truth->truth[i]);
    }
    if (sources_->truth->has_velocity) return;
    for (std::size_t i = 0; i < states.size() && states.size() > 1; ++i) {
      const NavState& a = states[i == 0 ? 0 : i - 1];
      const NavState& b = states[std::min(i + 1, states.size() - 1)];
      states[i].v_WB = (b.p_WB - a.p_WB) / to_seconds(b.time - a.time);
    }
  }

  /// The scans that have a stamp, which is not that of the scan before; those that came late in
  /// the order of their stamps.
  void keep(const Source& source, const std::vector<std::optional<Time>>& stamps) {
    Surveyed::Radar& radar = out_->radars.emplace_back();
    radar.role = source.role;
    std::vector<Time>& times = out_->outline.scan_times.emplace_back();
    std::size_t repeated = 0;
    for (const std::optional<Time>& stamp : stamps) {
      const bool again = stamp && !times.empty() && *stamp == times.back();
      radar.place.push_back(stamp && !again ? std::optional(times.size()) : std::nullopt);
      if (radar.place.back()) times.push_back(*stamp);
      repeated += again ? 1 : 0;
    }
    if (source.stamps.late.longest() > Time(0)) sort(&times, &radar.place);
    if (repeated == 0) return;
    sources_->note("{} scans have the stamp of the scan before and are left out", repeated);
  }

  static void sort(std::vector<Time>* times, std::vector<std::optional<std::size_t>>* place) {
    std::vector<std::size_t> order(times->size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [times](std::size_t i) { return (*times)[i]; });
    std::vector<std::size_t> place_of(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) place_of[order[k]] = k;
    for (std::optional<std::size_t>& each : *place) {
      if (each) *each = place_of[*each];
    }
    std::ranges::sort(*times);
  }

  /// Empty for scans without a trigger.
  std::vector<std::optional<Time>> stamp_by_triggers(const Source& radar) const {
    const Stamps& trigger = sources_->trigger->stamps;
    const std::string& name = sources_->trigger->role.name;
    const bool by_number = request_.trigger_match == TriggerMatch::kSequence;
    const bool counted = std::any_of(trigger.sequence.begin(), trigger.sequence.end(),
                                     [](std::uint32_t number) { return number > 0; });
    if (by_number && !counted) {
      sources_->fail(
          "messages on {} have no sequence numbers, as in ROS 2; match \"earlier\" does without",
          name);
    }
    require_no_zero(*sources_->trigger);
    std::map<std::uint32_t, std::map<Time, Time>> triggers;  // of a number: received, stamp
    const auto key = [by_number](std::uint32_t number) { return by_number ? number : 0; };
    for (std::size_t i = 0; i < trigger.count; ++i) {
      triggers[key(trigger.sequence[i])][trigger.received[i]] = trigger.header[i];
    }
    const double offset = request_.radar_offset;
    std::vector<std::optional<Time>> stamps(radar.stamps.count);
    std::size_t found = 0;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      const std::map<Time, Time>& candidates = triggers[key(radar.stamps.sequence[i])];
      const auto after = candidates.upper_bound(radar.stamps.received[i]);
      if (after == candidates.begin()) continue;
      stamps[i] = std::prev(after)->second + from_seconds(offset);
      ++found;
    }
    if (found == 0) sources_->fail("no scan on {} has a trigger on {}", radar.role.name, name);
    sources_->note(
        "{}: {} messages, {} stamped by the last trigger before on {}{}{}; {} without "
        "one are left out",
        radar.role.name, stamps.size(), found, name, by_number ? ", of the same number" : "",
        offset == 0.0 ? "" : fmt::format(", and moved by {} s", offset), stamps.size() - found);
    return stamps;
  }

  void require_no_zero(const Source& source) const {
    const bool is_trigger = &source == sources_->trigger;
    if (is_trigger ? source.stamps.zeros == 0 : source.stamps.has_headers()) return;
    sources_->fail("{} of {} header stamps on {} are zero{}", source.stamps.zeros,
                   source.stamps.count, source.role.name,
                   is_trigger ? "" : fmt::format("; use --{}-clock receive", source.role.role));
  }

  Surveyed::Imu stamp_imu(Source* source, Clock clock) {
    const Stamps& stamps = source->stamps;
    const auto intervals = static_cast<std::int64_t>(std::max<std::size_t>(stamps.count, 2) - 1);
    return {source->role, stamping(source, clock, request_.imu_offset),
            (stamps.last_received - stamps.first_received) / intervals,
            clock == Clock::kReceive ? Time(0) : stamps.late.longest()};
  }

  std::vector<Time> stamp_all(Source* source, Clock clock, double offset) {
    const Stamping how = stamping(source, clock, offset);
    std::vector<Time> times = source->stamps.header;
    for (std::size_t i = 0; i < times.size(); ++i) {
      times[i] = how.stamp(times[i], source->stamps.received[i], i);
    }
    return times;
  }

  /// @param by_headers as the IMU is; a topic on another clock, or without stamps, is put there by
  /// its receive times
  std::vector<Time> stamp_other(Source* source, bool by_headers) {
    Stamps& imu = sources_->imu->stamps;
    const Stamps& of = source->stamps;
    const bool same = of.has_times() && (of.is_on_clock_of(imu) || !of.is_recorded_with(imu));
    if (!by_headers) return stamp_all(source, Clock::kAuto, request_.imu_offset);
    if (same) return stamp_all(source, Clock::kHeader, request_.imu_offset);
    return stamp_all(source, Clock::kAuto, request_.imu_offset - to_seconds(imu.delay()));
  }

  Stamping stamping(Source* source, Clock clock, double offset) {
    Stamps& stamps = source->stamps;
    if (clock == Clock::kAuto) clock = stamps.has_times() ? Clock::kCarried : Clock::kReceive;
    if (clock != Clock::kReceive) require_no_zero(*source);
    const bool received = clock == Clock::kReceive;
    const Time delay = clock == Clock::kCarried ? stamps.delay() : Time(0);
    std::string text = received ? "stamped when they were received" : "stamped by their headers";
    if (clock == Clock::kCarried) {
      text += fmt::format(", moved by {:.9f} s onto the receive clock", to_seconds(delay));
    }
    if (stamps.zeros > 0) text += fmt::format(" ({} header stamps are zero)", stamps.zeros);
    if (!stamps.has_times() && stamps.has_headers()) {
      text += fmt::format(" ({} header stamps are those of the message before)", stamps.repeats);
    }
    if (offset != 0.0) text += fmt::format(", and by {} s", offset);
    if (const Time late = stamps.late.longest(); late > Time(0) && !received) {
      text += fmt::format(", in the order of these: {} came up to {:.3f} s late",
                          stamps.late.count(), to_seconds(late));
    }
    sources_->note("{}: {} messages, {}", source->role.name, stamps.count, text);
    Stamping how{received, received ? Shifts() : stamps.shifts(), delay + from_seconds(offset),
                 stamps.delay()};
    for (const Shifts::Jump& jump : how.shifts.jumps) {
      sources_->note(
          "{}: the header clock {}; later stamps are moved by {:+.6f} s: it goes on as the "
          "messages were received",
          source->role.name,
          jump.message == 0 ? "begins as another one"
                            : fmt::format("jumps by {:+.3f} s at message {}", to_seconds(jump.by),
                                          jump.message + 1),
          to_seconds(jump.added));
    }
    if (clock != Clock::kHeader && source->role.type == kCloudType && offset == 0.0) {
      sources_->note("scans arrive later than they were measured: --radar-offset, below zero");
    }
    return how;
  }

  Sources* sources_;
  const RecordingRequest& request_;
  Surveyed* out_;
};

}  // namespace

void put_on_one_clock(Sources* sources, Surveyed* out) {
  OneClock(sources, out).run();
}

}  // namespace rio::bag

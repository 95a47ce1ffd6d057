// SPDX-License-Identifier: BSD-3-Clause
#include "live/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "live/port.hpp"

namespace rio::live {
namespace {

/// Bytes of one packet are closer together than this, USB included.
constexpr Time kPause = std::chrono::milliseconds(5);
/// So much faster than configured is no radar, but a file read at once.
constexpr double kAtOnce = 0.1;
constexpr std::uint64_t kFewFrames = 20;  // too few to judge their times by
constexpr std::uint64_t kFewPackets = 3;  // not of the demo, by which another one is certain

/// Whether the bytes took longer than on the wire by more than half of the pause between packets.
bool is_made_up(const ti::Frame& frame, const ti::FrameTiming& timing) {
  const double wire = timing.baud > 0.0 ? frame.bytes * kBitsPerByte / timing.baud : 0.0;
  const double period = to_seconds(timing.period);
  return to_seconds(frame.last_arrival - frame.first_arrival) >
         0.5 * (std::min(wire, period) + period);
}

/// Whether several packets tell it: one may be damaged.
bool is_certain(const ti::PacketReader& reader) {
  using ti::StreamState;
  const ti::PacketCounters& counters = reader.counters();
  if (counters.other_sdk + counters.damaged + counters.cut_short < kFewPackets) return false;
  const StreamState state = reader.state();
  return state == StreamState::kOldSdk || state == StreamState::kNewSdk ||
         state == StreamState::kOtherDemo || state == StreamState::kCutShort;
}

}  // namespace

Session::Session(const SessionSetup& setup, std::vector<Listener*> listeners)
    : listeners_(std::move(listeners)), imu_on_host_clock_(setup.imu_on_host_clock) {
  std::string why;
  odometry_ = Odometry::create(setup.options, &why);
  if (odometry_ == nullptr) throw std::runtime_error(why);
  odometry_->on_scan([this] { tell_estimate(); });
  if (setup.radars.size() != setup.options.radars()) {
    throw std::runtime_error("not as many radars as the sensor files and options tell of");
  }
  for (const ti::FrameTiming& timing : setup.radars) {
    if (!timing.validate(&why)) throw std::runtime_error("timing of the radar: " + why);
    radars_.push_back({timing, ti::PacketReader(), ti::FrameClock(timing), {}, 0, 0, false});
  }
}

void Session::radar(std::size_t r, const std::uint8_t* bytes, std::size_t count, Time arrival) {
  radars_[r].reader.push(bytes, count, arrival, [this, r](ti::Frame& frame) { take(r, &frame); });
}

std::string Session::times_problem(std::size_t r) const {
  const Radar& radar = radars_[r];
  const FrameCounters& frames = radar.frames;
  if (radar.has_subframes) {
    return "several packets have one frame number: advanced frames (subframes) are not supported "
           "live, use one frame (dfeDataOutputMode 1)";
  }
  const double configured = to_seconds(radar.timing.period);
  const std::optional<double> period = radar.clock.other_period();
  if (period && *period < kAtOnce * configured) {
    return "the packets come all at once: a file read at once has no times, play it at its speed";
  }
  if (period) {
    return fmt::format(
        "frames come every {:.1f} ms by their numbers, not every {:.1f}: correct rate_hz of "
        "sensor.yaml, or --radar-cfg",
        1e3 * *period, 1e3 * configured);
  }
  const std::uint64_t unusable = frames.untimed + frames.made_up;
  if (unusable <= frames.used || unusable < kFewFrames) return {};
  if (frames.made_up > frames.untimed) {
    return "most packets are not used: their bytes come more slowly than baud rate and rate_hz say";
  }
  return "the packets come all at once, from a file, or their numbers do not count the frames: "
         "most are not used";
}

/// Stamps it, in the clock of the arrivals.
bool Session::is_left_out(Radar* radar, ti::Frame* frame) {
  const int odd = radar->clock.odd();
  frame->scan.time = radar->clock.stamp(*frame);
  const bool untimed = radar->clock.odd() != odd;
  const bool made_up = is_made_up(*frame, radar->timing);
  if (frame->number == radar->number && frame->subframe != radar->subframe) {
    radar->has_subframes = true;
  }
  radar->number = frame->number;
  radar->subframe = frame->subframe;
  if (untimed) ++radar->frames.untimed;
  if (made_up) ++radar->frames.made_up;
  if (imu_samples_ == 0) ++radar->frames.without_imu;
  return untimed || made_up || imu_samples_ == 0;
}

void Session::take(std::size_t r, ti::Frame* frame) {
  newest_frame_ = std::max(newest_frame_, frame->last_arrival);
  if (newest_imu_ == Time{0}) newest_imu_ = newest_frame_;
  if (is_left_out(&radars_[r], frame)) return;
  ++radars_[r].frames.used;
  frame->scan.time -= host_offset();
  pending_[next_pending_++ % pending_.size()] = {frame->scan.time, frame->last_arrival};
  (void)odometry_->add_scan(frame->scan, r);  // its outcome is counted
  tell([&](Listener* listener) { listener->on_scan(*this, frame->scan, r); });
}

/// A frame waits for the next bytes of its radar no longer than a pause.
void Session::flush_held(Time now) {
  for (std::size_t r = 0; r < radars_.size(); ++r) {
    const std::optional<Time> since = radars_[r].reader.held_since();
    if (since && now - *since > kPause) flush(r);
  }
}

void Session::flush(std::size_t r) {
  radars_[r].reader.flush([this, r](ti::Frame& frame) { take(r, &frame); });
}

void Session::end() {
  for (std::size_t r = 0; r < radars_.size(); ++r) flush(r);
  tell([](Listener* listener) { listener->on_end(); });
}

void Session::imu(const ImuSample& sample, Time arrival) {
  flush_held(arrival);
  ++imu_samples_;
  newest_imu_ = arrival;
  offset_.add(sample.time, arrival);
  (void)odometry_->add_imu(sample);  // its outcome is counted
  tell([&](Listener* listener) { listener->on_imu(*this, sample); });
}

/// Within a call of the estimator, through which no exception passes.
void Session::tell_estimate() noexcept {
  const UpdateReport& report = odometry_->report();
  if (report.status != Status::kOk) return;
  const auto of_it = [&report](const Pending& scan) { return scan.stamp == report.time; };
  const auto scan = std::find_if(pending_.begin(), pending_.end(), of_it);
  if (scan == pending_.end()) return;
  tell([&](Listener* listener) { listener->on_estimate(*this, scan->arrival); });
}

template <class Call>
void Session::tell(const Call& call) {
  std::erase_if(listeners_, [&](Listener* listener) {
    try {
      call(listener);
    } catch (const std::exception& error) {
      failed_ += (failed_.empty() ? "" : "; ") + std::string(error.what());
      return true;
    }
    return false;
  });
}

Time Session::host_offset() const {
  if (imu_on_host_clock_) return Time{0};
  return configured_offset_.value_or(offset_.offset());
}

std::string ScanWatch::look(const ti::PacketReader& reader, Time now, const std::string& times) {
  const ti::PacketCounters& counters = reader.counters();
  if (!waits_ || counters.points != at_.points) {
    const bool back = silent_;
    waits_ = true;
    silent_ = false;
    at_ = counters;
    since_ = now;
    if (back) return "scans again";
  }
  if (is_certain(reader) && reader.state() != said_) {
    said_ = reader.state();
    return reader.problem();
  }
  if (!times.empty() && !timed_) {
    timed_ = true;
    return times;
  }
  if (silent_ || now - since_ < kPatience) return {};
  silent_ = true;
  const std::string problem = reader.problem();
  if (counters.bytes == 0) return "no scan for 10 s; " + problem;
  if (counters.frames > at_.frames && problem.empty()) {
    return "packets without points for 10 s: nothing is detected (clutter removal is on, or the "
           "thresholds are too high)";
  }
  const std::uint64_t bytes = counters.bytes - at_.bytes;
  const std::string seen = bytes == 0 ? "no byte came" : std::to_string(bytes) + " bytes came";
  return "no scan for 10 s; " + seen + (bytes == 0 || problem.empty() ? "" : ": " + problem);
}

}  // namespace rio::live

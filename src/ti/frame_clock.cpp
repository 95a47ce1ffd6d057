// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/frame_clock.hpp"

#include <algorithm>
#include <cmath>

#include "rio/core/assert.hpp"

namespace rio::ti {
namespace {

constexpr int kMany = 5;  // consecutive frames that are not accidental
constexpr Time kLasting = std::chrono::seconds(1);
constexpr double kBusy = 1.0;             // longest lateness of a busy host [s]
constexpr double kBitsPerByte = 10.0;     // start, eight, stop
constexpr std::size_t kLeastWindow = 16;  // [frames]
constexpr std::size_t kMostWindow = 4096;
constexpr std::size_t kNewest = 128;  // arrivals that measure the period
constexpr std::size_t kFewest = 10;   // of them, to judge it
constexpr std::size_t kAtOnce = 64;   // more frames do not fit in the buffer of a serial port
constexpr double kBurst = 0.25;  // of the period: frames that had to wait, and then came at once
constexpr std::uint32_t kLongestPair = 512;  // [frames]; more is a jump of the number
constexpr double kWrongRate = 0.01;          // no quartz is that far off
constexpr double kJitter = 0.014;  // of two arrivals 10 ms late, their difference's quartiles [s]
constexpr double kSignificant = 5.0;              // times the median's uncertainty
constexpr Time kLongest = std::chrono::hours(1);  // upper bound of all times

std::size_t frames_in(const FrameTiming& timing) {
  const double frames = to_seconds(timing.window) / to_seconds(timing.period);
  const double most = static_cast<double>(kMostWindow);
  return std::max(kLeastWindow, static_cast<std::size_t>(std::min(frames, most)));
}

bool within(Time value, Time least, Time most) {
  return value >= least && value <= most;
}

}  // namespace

bool FrameTiming::validate(std::string* why) const {
  const struct {
    bool holds;
    const char* rule;
  } rules[] = {
      {within(period, std::chrono::milliseconds(1), kLongest), "period must be 1 ms to 1 h"},
      {within(chirp_block, Time{0}, period), "chirp_block must be 0 to the period"},
      {within(processing_delay, Time{0}, kLongest), "processing_delay must be 0 to 1 h"},
      {within(trigger_delay, Time{0}, kLongest), "trigger_delay must be 0 to 1 h"},
      {baud == 0.0 || (baud >= 1200.0 && baud <= 1e9), "baud must be 0 or 1200 to 1e9"},
      {max_drift >= 0.0 && max_drift <= 0.01, "max_drift must be 0 to 0.01"},
      {within(window, Time{0}, 24 * kLongest), "window must be 0 to 24 h"},
  };
  for (const auto& [holds, rule] : rules) {
    if (holds) continue;
    if (why != nullptr) *why = rule;
    return false;
  }
  return true;
}

FrameClock::FrameClock(const FrameTiming& timing)
    : timing_(timing),
      period_(to_seconds(timing.period)),
      newest_(kNewest),
      window_(frames_in(timing)) {
  RIO_ASSERT(timing.validate());
  hull_.reserve(window_.capacity());
}

void FrameClock::reset() {
  started_ = false;
  odd_ = restarts_ = 0;
  trigger_count_ = 0;
  newest_.clear();
  at_once_ = 0;
}

void FrameClock::add_trigger(Time edge) {
  triggers_[trigger_count_++ % triggers_.size()] = edge;
}

Time FrameClock::stamp(const Frame& frame) {
  const Time first = first_byte(frame);
  const Time to_middle = timing_.processing_delay + timing_.chirp_block / 2;
  count(frame.number, first);
  if (!started_) start(frame, first);
  Arrival now = arrival(frame, first);
  const double lateness = now.y - (intercept_ + slope_ * now.x);
  if (contradicts(frame, first, lateness)) {
    const bool busy =
        frame.number > newest_number_ && lateness > 0.0 && lateness < kBusy && !other_period();
    if (run_ == kMany && first - run_begin_ >= kLasting) {
      ++restarts_;
      start(frame, first);
      now = {};
    } else if (!busy) {
      ++odd_;
      return triggered(first - to_middle);
    }
  }
  newest_number_ = frame.number;
  window_.push_back(now);
  fit();
  const double begun = intercept_ + slope_ * now.x + now.x * period_;
  return triggered(origin_time_ + from_seconds(begun) - to_middle);
}

/// Of frames that came at once only the last counts: it had to wait least, and the others would
/// tell how fast the host reads.
void FrameClock::count(std::uint32_t number, Time first_byte) {
  const Counted now{number, first_byte};
  if (!newest_.empty() && number < newest_.back().number) newest_.clear();  // it has restarted
  const Time burst = from_seconds(kBurst * period_);
  if (!newest_.empty() && within(first_byte - newest_.back().first_byte, Time{0}, burst)) {
    newest_[newest_.size() - 1] = now;
    ++at_once_;
  } else {
    newest_.push_back(now);
    at_once_ = 0;
  }
}

/// The median over pairs a third of the arrivals apart: a step of the times (a pause of the radar,
/// a clock that was set) is in half of the pairs at most, which moves a quartile away.
std::optional<double> FrameClock::other_period() const {
  if (newest_.size() == 1 && at_once_ >= kAtOnce) return 0.0;
  if (newest_.size() < kFewest) return std::nullopt;
  const std::size_t lag = newest_.size() / 3;
  std::array<double, kNewest> periods{};
  std::size_t pairs = 0;
  for (std::size_t i = lag; i < newest_.size(); ++i) {
    const Counted& begin = newest_[i - lag];
    const std::uint32_t frames = newest_[i].number - begin.number;
    if (frames == 0 || frames > kLongestPair) continue;
    periods[pairs++] = to_seconds(newest_[i].first_byte - begin.first_byte) / frames;
  }
  if (2 * pairs < newest_.size()) return std::nullopt;
  std::sort(periods.begin(), periods.begin() + static_cast<long>(pairs));
  const double median = periods[pairs / 2];
  const double spread = periods[pairs - 1 - pairs / 4] - periods[pairs / 4];
  const double doubt = kSignificant * std::max(spread, kJitter / static_cast<double>(lag)) /
                       std::sqrt(static_cast<double>(pairs));
  if (std::abs(median - period_) <= std::max(doubt, kWrongRate * period_)) return std::nullopt;
  return median;
}

/// Neither estimate is ever early: the bytes came at the rate of the UART at most.
Time FrameClock::first_byte(const Frame& frame) const {
  if (timing_.baud == 0.0) return frame.first_arrival;
  const Time on_wire = from_seconds(frame.bytes * kBitsPerByte / timing_.baud);
  return std::min(frame.first_arrival, frame.last_arrival - on_wire);
}

void FrameClock::start(const Frame& frame, Time first_byte) {
  started_ = true;
  origin_number_ = newest_number_ = frame.number;
  origin_time_ = first_byte;
  slope_ = intercept_ = 0.0;
  run_ = 0;
  window_.clear();
}

FrameClock::Arrival FrameClock::arrival(const Frame& frame, Time first_byte) const {
  const double x = static_cast<double>(frame.number) - static_cast<double>(origin_number_);
  return {x, to_seconds(first_byte - origin_time_) - x * period_};
}

/// Whether the frame contradicts the line; counts consecutive such frames.
bool FrameClock::contradicts(const Frame& frame, Time first_byte, double lateness) {
  const bool backwards = frame.number < newest_number_;
  if (!backwards && std::abs(lateness) <= 0.5 * period_) {
    run_ = 0;
    return false;
  }
  if (run_ == 0) run_begin_ = first_byte;
  run_ = std::min(run_ + 1, kMany);
  return true;
}

/// The line below all points that is highest at their mean: the edge of the lower hull there; if
/// that is steeper than the drift bound, the steepest allowed line through its lowest point.
void FrameClock::fit() {
  hull_.clear();
  double mean = 0.0;
  for (std::size_t i = 0; i < window_.size(); ++i) {
    const Arrival p = window_[i];
    mean += p.x / static_cast<double>(window_.size());
    while (hull_.size() > 1) {
      const Arrival& a = hull_[hull_.size() - 2];
      const Arrival& b = hull_.back();
      if ((b.x - a.x) * (p.y - a.y) > (b.y - a.y) * (p.x - a.x)) break;
      hull_.pop_back();
    }
    hull_.push_back(p);
  }
  std::size_t right = 1;
  while (right + 1 < hull_.size() && hull_[right].x < mean) ++right;
  slope_ = 0.0;
  if (right < hull_.size() && hull_[right].x > hull_[right - 1].x) {
    const Arrival& a = hull_[right - 1];
    const Arrival& b = hull_[right];
    const double most = timing_.max_drift * period_;
    slope_ = std::clamp((b.y - a.y) / (b.x - a.x), -most, most);
  }
  intercept_ = hull_.front().y - slope_ * hull_.front().x;
  for (const Arrival& p : hull_) intercept_ = std::min(intercept_, p.y - slope_ * p.x);
}

/// The stamp from the trigger that started the frame, if there was one.
Time FrameClock::triggered(Time stamp) const {
  const Time to_middle = timing_.trigger_delay + timing_.chirp_block / 2;
  Time best = stamp;
  Time nearest = timing_.period / 2;
  for (std::size_t i = 0; i < std::min(trigger_count_, triggers_.size()); ++i) {
    const Time candidate = triggers_[i] + to_middle;
    const Time off = candidate > stamp ? candidate - stamp : stamp - candidate;
    if (off > nearest) continue;
    nearest = off;
    best = candidate;
  }
  return best;
}

}  // namespace rio::ti

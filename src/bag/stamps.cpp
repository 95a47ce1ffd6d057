// SPDX-License-Identifier: BSD-3-Clause
#include "stamps.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <numeric>
#include <utility>

namespace rio::bag {

namespace {

constexpr Time kJump(300'000'000);
constexpr Time kBack(50'000'000);  // a clock that is set back; messages that are swapped are nearer
constexpr Time kJitter(100'000'000);
constexpr Time kPause(500'000'000);
constexpr Time kSecond(1'000'000'000);
constexpr Time kTwice(10'000'000);  // a message that is there twice comes within this
constexpr std::size_t kStray = 3;   // so many messages with another clock are corrupt stamps

bool is_far(Time a, Time b) {
  return std::chrono::abs(a - b) > kJump;
}

}  // namespace

bool LateMessages::add(Time header) {
  constexpr std::size_t kMost = 1024;  // seconds of an IMU
  if (last_.empty() || header >= last_.back()) {
    last_.push_back(header);
    while (last_.size() > kMost) last_.pop_front();
    return false;
  }
  ++behind_;
  const auto after = std::upper_bound(last_.begin(), last_.end(), header);
  if (after == last_.begin()) return false;
  std::vector<Time> intervals;
  std::adjacent_difference(last_.begin(), last_.end(), std::back_inserter(intervals));
  intervals.erase(intervals.begin());
  const auto quarter = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 4);
  std::nth_element(intervals.begin(), quarter, intervals.end());  // many are missing so far
  // one that is set back falls nearer to one of its neighbours than half of an interval
  const Time nearest = std::min(*after - header, header - *std::prev(after));
  if (5 * nearest < 3 * *quarter) return false;
  longest_ = std::max(longest_, last_.back() - header);
  ++fill_;
  last_.insert(after, header);
  return true;
}

void Stamps::add(const Header& head, Time when, bool all) {
  const bool is_late = head.stamp != Time(0) && late.add(head.stamp);
  if (head.stamp == Time(0)) {
    ++zeros;
  } else if (is_late) {  // on the clock of those before
    const auto filled = [when](const Pause& p) { return when < p.end && when > p.end - p.length; };
    std::erase_if(pauses_, filled);
  } else {
    const Time delay = when - head.stamp;
    // a late or lost message moves both clocks, or the receive time alone
    const Time step = head.stamp - stamped_;
    const Time passed = when - stamped_received_;
    repeats += all && step == Time(0) && passed > kTwice ? 1 : 0;
    backs += step < Time(0) ? 1 : 0;
    const bool odd = step < Time(0) || step > kJump;
    const bool set_back = !pieces_.empty() && is_step_back(step, passed);
    const bool ahead = !pieces_.empty() && is_small_step_ahead(step, passed);
    const bool opens = set_back || ahead || (!pieces_.empty() && odd && is_far(step, passed));
    if (opens && pieces_.size() == 1 && pieces_[0].delays.size() <= kStray) pieces_.clear();
    if (pieces_.empty()) pieces_.push_back({0, Time(0), head.stamp, kJitter, {}});
    const std::size_t n = pieces_.size();
    const bool back = n > 1 && pieces_.back().delays.size() <= kStray &&
                      !is_far(delay, pieces_[n - 2].delays.back());
    if (opens && back) {
      pieces_.pop_back();
    } else if (opens && !pieces_.back().delays.empty()) {
      pieces_.push_back(
          {count, step - passed, head.stamp, set_back || ahead ? kBack : kJitter, {}});
    }
    pieces_.back().delays.push_back(delay);
    if (count > 0) note_pause(step, passed, when);
    stamped_ = head.stamp;
    stamped_received_ = when;
  }
  if (count++ == 0) {
    first = head;
    first_received = when;
  }
  if (!is_late) last = head;
  last_received = when;
  if (!all) return;
  header.push_back(head.stamp);
  received.push_back(when);
  sequence.push_back(head.sequence);
}

/// What is on its way when the clock is set has a header from before and is received behind.
void Stamps::note_pause(Time step, Time passed, Time when) {
  if (step > kPause) headers_went_on_ = when;
  if (passed > kPause) receiving_went_on_ = when;
  const Time both = std::min(headers_went_on_, receiving_went_on_);
  if (std::max(step, passed) <= kPause || when - both > kSecond) return;
  const bool at_once = std::min(step, passed) > kPause;  // the rest is a jump of one clock
  pauses_.push_back({when, at_once ? std::min(step, passed) : std::max(step, passed)});
  headers_went_on_ = receiving_went_on_ = Time(0);
}

/// Of the newest piece.
Time Stamps::interval() const {
  const auto n = static_cast<std::int64_t>(pieces_.back().delays.size());
  return n < 2 ? Time(0) : (stamped_ - pieces_.back().first) / (n - 1);
}

bool Stamps::is_step_back(Time step, Time passed) const {
  const Time least = interval() > kBack ? interval() / 2 : Time(0);
  return step < least && passed - step > kBack;
}

bool Stamps::is_small_step_ahead(Time step, Time passed) const {
  return 2 * step > 3 * interval() && step - passed > kBack && step - passed <= kJump;
}

Time Stamps::Piece::median() {
  const auto middle = delays.begin() + static_cast<std::ptrdiff_t>(delays.size() / 2);
  std::nth_element(delays.begin(), middle, delays.end());
  return *middle;
}

Time Stamps::Piece::least() const {
  return *std::min_element(delays.begin(), delays.end());
}

std::size_t Stamps::anchor() const {
  const auto agrees = [](const Piece& piece) {
    return piece.delays.size() > kStray && std::chrono::abs(piece.least()) < kSecond;
  };
  const auto found = std::ranges::find_if(pieces_, agrees);
  return found == pieces_.end() ? 0 : static_cast<std::size_t>(found - pieces_.begin());
}

Time Stamps::delay() {
  return pieces_.empty() ? Time(0) : pieces_[anchor()].median();
}

Time Stamps::least_delay() const {
  return pieces_.empty() ? Time(0) : pieces_[anchor()].least();
}

bool Stamps::is_on_clock_of(const Stamps& other) const {
  const auto agree = [](Time a, Time b) { return std::chrono::abs(a - b) < kSecond; };
  return agree(least_delay(), other.least_delay()) ||
         (agree(first.stamp, other.first.stamp) && agree(last.stamp, other.last.stamp));
}

std::vector<Stamps::Pause> Stamps::common_pauses(const std::vector<const Stamps*>& others) const {
  constexpr Time kTogether(500'000'000);  // interval and delay of a radar
  std::vector<Pause> common;
  for (const Pause& pause : pauses_) {
    const bool all = std::all_of(others.begin(), others.end(), [&](const Stamps* other) {
      return std::any_of(other->pauses_.begin(), other->pauses_.end(), [&](const Pause& p) {
        return std::chrono::abs(p.end - pause.end) < kTogether &&
               std::chrono::abs(p.length - pause.length) < kTogether;
      });
    });
    if (all) common.push_back(pause);
  }
  return common;
}

Shifts Stamps::shifts() {
  Shifts out;
  const Time right = delay();
  Time least = pieces_.empty() ? Time(0) : pieces_.front().least();
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    if (pieces_[k].delays.size() <= kStray) continue;  // the end of the recording
    const Time before = std::exchange(least, pieces_[k].least());
    const bool ahead = pieces_[k].by > Time(0) && pieces_[k].jitter == kBack;
    if (ahead && pieces_[k].median() > before - kBack) continue;  // no longer late, as before
    const Time added = pieces_[k].median() - right;
    // up to the jitter of a delay it is no jump of the clock, but a message that came late
    if (std::chrono::abs(added - out.last()) < pieces_[k].jitter) continue;
    out.jumps.push_back({pieces_[k].begin, pieces_[k].by, added});
  }
  return out;
}

}  // namespace rio::bag

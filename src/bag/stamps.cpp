// SPDX-License-Identifier: BSD-3-Clause
#include "stamps.hpp"

#include <algorithm>

namespace rio::bag {

namespace {

constexpr Time kJump(300'000'000);
constexpr std::size_t kStray = 3;  // so many messages with another clock are corrupt stamps

/// Up to the jitter of a delay: no jump of the clock, but a message that came late.
bool is_same(Time a, Time b) {
  constexpr Time kJitter(100'000'000);
  return a - b < kJitter && b - a < kJitter;
}

bool is_far(Time a, Time b) {
  return a - b > kJump || b - a > kJump;
}

}  // namespace

void Stamps::add(const Header& head, Time when, bool all) {
  if (head.stamp == Time(0)) {
    ++zeros;
  } else {
    const Time delay = when - head.stamp;
    // a late or lost message moves both clocks, or the receive time alone
    const Time step = head.stamp - stamped_;
    const Time passed = when - stamped_received_;
    const bool odd = step < Time(0) || step > kJump;
    const bool opens = !pieces_.empty() && odd && is_far(step, passed);
    if (opens && pieces_.size() == 1 && pieces_[0].delays.size() <= kStray) pieces_.clear();
    if (pieces_.empty()) pieces_.emplace_back();
    const std::size_t n = pieces_.size();
    const bool back = n > 1 && pieces_.back().delays.size() <= kStray &&
                      !is_far(delay, pieces_[n - 2].delays.back());
    if (opens && back) {
      pieces_.pop_back();
    } else if (opens && !pieces_.back().delays.empty()) {
      pieces_.push_back({count, step - passed, {}});
    }
    pieces_.back().delays.push_back(delay);
    stamped_ = head.stamp;
    stamped_received_ = when;
  }
  if (count++ == 0) {
    first = head;
    first_received = when;
  }
  last = head;
  last_received = when;
  if (!all) return;
  header.push_back(head.stamp);
  received.push_back(when);
  sequence.push_back(head.sequence);
}

Time Stamps::Piece::median() {
  const auto middle = delays.begin() + static_cast<std::ptrdiff_t>(delays.size() / 2);
  std::nth_element(delays.begin(), middle, delays.end());
  return *middle;
}

Time Stamps::delay() {
  return pieces_.empty() ? Time(0) : pieces_.front().median();
}

Shifts Stamps::shifts() {
  Shifts out;
  for (std::size_t k = 1; k < pieces_.size(); ++k) {
    if (pieces_[k].delays.size() <= kStray) continue;  // the end of the recording
    const Time added = pieces_[k].median() - pieces_.front().median();
    out.add({pieces_[k].begin, pieces_[k].by, is_same(added, out.last()) ? out.last() : added});
  }
  return out;
}

}  // namespace rio::bag

// SPDX-License-Identifier: BSD-3-Clause
#include "live/clock_offset.hpp"

#include <algorithm>

namespace rio::live {
namespace {

constexpr Time kSpan = std::chrono::seconds(5);
constexpr Time kJump = std::chrono::seconds(1);
constexpr int kMany = 5;

}  // namespace

void ClockOffset::start(Time offset, Time arrival) {
  known_ = true;
  odd_ = 0;
  begin_ = arrival;
  now_ = before_ = offset;
}

void ClockOffset::add(Time stamp, Time arrival) {
  const Time offset = arrival - stamp;
  if (!known_) return start(offset, arrival);
  const bool odd = offset > this->offset() + kJump || offset < this->offset() - kJump;
  if (odd && ++odd_ < kMany) return;
  if (odd) return start(offset, arrival);
  odd_ = 0;
  if (arrival - begin_ >= kSpan) {
    begin_ = arrival;
    before_ = now_;
    now_ = offset;
  }
  now_ = std::min(now_, offset);
}

}  // namespace rio::live

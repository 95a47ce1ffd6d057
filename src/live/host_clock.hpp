// SPDX-License-Identifier: BSD-3-Clause
// The clock of the arrivals, CLOCK_MONOTONIC of this machine, and its offset from that of a sensor.
#pragma once

#include <algorithm>
#include <chrono>

#include "rio/types.hpp"

namespace rio::live {

class HostClock {
 public:
  /// @param speed factor of the clock from now on, for simulated sensors
  explicit HostClock(double speed = 1.0) : speed_(speed), begin_(real()) {}

  static Time real() { return std::chrono::steady_clock::now().time_since_epoch(); }
  Time now() const { return begin_ + from_seconds(speed_ * to_seconds(real() - begin_)); }
  /// A duration of this clock in real time.
  Time to_real(Time duration) const { return from_seconds(to_seconds(duration) / speed_); }

 private:
  double speed_;
  Time begin_;
};

/// Samples can only be late: offset = arrival - stamp is the true one plus the delay, and the
/// smallest of the last seconds is nearest to the truth. The samples keep their own stamps; stamps
/// of arrival on this machine, as of radar frames, are converted to the sensor's clock.
class ClockOffset {
 public:
  /// Call once per sample. Five in a row that are off by more than a second restart it: a clock has
  /// jumped.
  void add(Time stamp, Time arrival) {
    constexpr Time kSpan = std::chrono::seconds(5);
    constexpr Time kJump = std::chrono::seconds(1);
    constexpr int kMany = 5;
    const Time offset = arrival - stamp;
    const bool odd = offset > this->offset() + kJump || offset < this->offset() - kJump;
    if (known_ && odd && ++odd_ < kMany) return;
    if (!known_ || odd) {
      known_ = true;
      begin_ = arrival;
      before_ = now_ = offset;
    }
    odd_ = 0;
    if (arrival - begin_ >= kSpan) {
      begin_ = arrival;
      before_ = now_;
      now_ = offset;
    }
    now_ = std::min(now_, offset);
  }

  /// This machine's clock minus the sensor's: the smallest offset of the last five to ten seconds.
  Time offset() const { return std::min(before_, now_); }

 private:
  bool known_ = false;
  int odd_ = 0;     ///< in a row
  Time begin_{0};   ///< of the current five seconds
  Time now_{0};     ///< smallest in them
  Time before_{0};  ///< smallest in the five seconds before
};

}  // namespace rio::live

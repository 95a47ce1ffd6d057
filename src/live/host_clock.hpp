// SPDX-License-Identifier: BSD-3-Clause
// The clock of the arrivals: CLOCK_MONOTONIC of this machine.
#pragma once

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

}  // namespace rio::live

// SPDX-License-Identifier: BSD-3-Clause
#include "scan_clock.hpp"

#include <algorithm>
#include <utility>

#include "rio/checks/stamp_guard.hpp"

namespace rio {

Time ScanClock::corrected(Time stamp, std::optional<Time> imu) {
  stepped_ = false;
  if (!imu || !is_stamp(stamp)) return stamp;
  observe(stamp - shift_, *imu);
  if (run_.count == kMany) {
    shift_ += run_.lag - lag_;
    newest_ = stamp - shift_;
    run_ = Run{};
    jump_.reset();
    stepped_ = true;
  }
  return stamp - shift_;
}

void ScanClock::imu_jumped(Time by) {
  if (moving_ < kMean) return reset();
  lag_ = lag_moving_;
  jump_ = by;
  newest_.reset();
  run_ = Run{};
}

void ScanClock::observe(Time stamp, Time imu) {
  const Time lag = stamp - imu;
  const Time before = newest_.value_or(stamp);
  const Time interval = newest_ ? stamp - before : interval_;
  const Time arrival = imu - std::exchange(imu_, imu);
  newest_ = lag - lag_ < kOdd ? std::max(before, stamp) : before;
  const bool away = std::chrono::abs(lag - lag_) > kStep && (jump_ || arrival > Time{0});
  if (run_.count > 0 && away && std::chrono::abs(lag - run_.lag) < kSteady) {
    ++run_.count;
    run_.lag += (lag - run_.lag) / run_.count;
    return;
  }
  run_ = Run{};
  const bool ends_delay = jump_ && *jump_ > Time{0} && lag > least_ - kStep;
  if (jump_ && away && !ends_delay) {
    if (std::chrono::abs(lag - lag_ + *jump_) < kStep) run_ = {lag, 1};
    return;
  }
  jump_.reset();
  if (lags_ == kMean && away && is_due(arrival) && !is_due(interval)) {
    run_ = {lag, 1};
    return;
  }
  lags_ = std::min(lags_ + 1, kMean);
  lag_ += lags_ < kMean ? (lag - lag_) / lags_ : std::clamp(lag - lag_, -kPull, kPull) / kMean;
  least_ = lags_ < kMean ? lag_ : std::min(least_, lag_);
  if (is_due(interval) || lags_ < kMean) interval_ += (interval - interval_) / lags_;
  if (arrival == Time{0}) return;
  lag_moving_ = lag_;
  moving_ = std::min(moving_ + 1, kMean);
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "scan_clock.hpp"

#include <algorithm>
#include <utility>

#include "rio/checks/stamp_guard.hpp"

namespace rio {

Time ScanClock::corrected(Time stamp, std::optional<Time> imu) {
  stepped_ = false;
  if (!imu || !is_stamp(stamp)) return stamp;
  const Scan scan{stamp - shift_, *imu};
  observe(scan);
  if (run_.count == kMany) {
    const Time step = run_.lag - lag_;
    shift_ += step;
    last_->stamp -= step;
    run_ = Run{};
    stepped_ = true;
  }
  return stamp - shift_;
}

void ScanClock::observe(const Scan& scan) {
  const Time lag = scan.stamp - scan.imu;
  const std::optional<Scan> before = std::exchange(last_, scan);
  if (!before) {
    lag_ = lag;
    return;
  }
  const Time interval = scan.stamp - before->stamp;
  const bool away = std::chrono::abs(lag - lag_) > kStep && scan.imu > before->imu;
  if (run_.count > 0 && away && std::chrono::abs(lag - run_.lag) < kSteady) {
    ++run_.count;
    run_.lag += (lag - run_.lag) / run_.count;
    return;
  }
  run_ = Run{};
  if (lags_ == kMean && away && is_due(scan.imu - before->imu) && !is_due(interval)) {
    run_ = {lag, 1};
    return;
  }
  lags_ = std::min(lags_ + 1, kMean);
  lag_ += (lag - lag_) / lags_;
  if (is_due(interval) || lags_ < kMean) interval_ += (interval - interval_) / lags_;
}

}  // namespace rio

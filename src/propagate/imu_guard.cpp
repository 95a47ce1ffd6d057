// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/imu_guard.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

ImuFault ImuGuard::check(const ImuSample& sample) {
  Vector6d x;
  x << sample.gyro_B, sample.accel_B;
  const bool repeats = seen_ > 0.0 && x == last_;
  const bool outside = out_of_range(x);
  last_ = x;
  if (outside) return ImuFault::kOutOfRange;
  if (repeats && seen_ > kKnown && repeated_ < kRarely * seen_) return ImuFault::kFrozen;
  seen_ += 1.0;
  repeated_ += repeats ? 1.0 : 0.0;
  return ImuFault::kNone;
}

bool ImuGuard::out_of_range(const Vector6d& x) {
  bool outside = false;
  for (int i = 0; i < 6; ++i) {
    const double value = std::abs(x[i]);
    if (value >= (i < 3 ? max_rate_ : max_accel_)) {
      outside = true;
      continue;
    }
    const bool stays = seen_ > 0.0 && x[i] == last_[i] && value >= largest_[i];
    outside = outside || (stays && value > (i < 3 ? kSmallestRate : kSmallestAccel));
    largest_[i] = std::max(largest_[i], value);
  }
  return outside;
}

}  // namespace rio

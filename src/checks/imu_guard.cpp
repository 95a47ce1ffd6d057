// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/imu_guard.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

ImuFault ImuGuard::check(const ImuSample& sample) {
  Vector6d x;
  x << sample.gyro_B, sample.accel_B;
  const bool outside = out_of_range(x);
  count_repeats(x);
  last_ = x;
  if (outside) return ImuFault::kOutOfRange;
  if (x.isZero(0.0) && !largest_.isZero(0.0)) return ImuFault::kFrozen;
  if (seen_ > kKnown && is_frozen()) return ImuFault::kFrozen;
  seen_ += 1.0;
  for (int i = 0; i < 6; ++i) {
    share_[i] += ((repeats_[i] > 0.0 ? 1.0 : 0.0) - share_[i]) / std::min(seen_, kMemory);
  }
  if (seen_ > kKnown) most_ = most_.cwiseMax(share_);
  return ImuFault::kNone;
}

void ImuGuard::count_repeats(const Vector6d& x) {
  for (int i = 0; i < 6; ++i) {
    const bool repeats = seen_ > 0.0 && x[i] == last_[i];
    repeats_[i] = repeats ? repeats_[i] + 1.0 : 0.0;
    recent_[i] += ((repeats ? 1.0 : 0.0) - recent_[i]) / kRecent;
  }
}

bool ImuGuard::is_frozen() const {
  constexpr double kByChance = -20.7;  // log 1e-9
  double all = 0.0;
  bool every = true;
  for (int sensor = 0; sensor < 2; ++sensor) {
    double chance = 0.0;
    bool repeats = true;
    for (int i = 3 * sensor; i < 3 * sensor + 3; ++i) {
      if (repeats_[i] == 0.0) {
        repeats = false;
        continue;
      }
      const double of_axis = repeats_[i] * std::log(most_[i]);
      if (of_axis < kByChance && varies(sensor, i)) return true;
      chance += of_axis;
    }
    if (repeats && chance < kByChance && varies(1 - sensor)) return true;
    all += chance;
    every = every && repeats;
  }
  return every && all < kByChance;
}

bool ImuGuard::varies(int sensor, int but) const {
  constexpr double kVaries = 0.3;  // share of repeats at most
  for (int i = 3 * sensor; i < 3 * sensor + 3; ++i) {
    if (i != but && recent_[i] < kVaries) return true;
  }
  return false;
}

bool ImuGuard::out_of_range(const Vector6d& x) {
  bool outside = false;
  for (int i = 0; i < 6; ++i) {
    const double value = std::abs(x[i]);
    if (value >= (i < 3 ? max_rate_ : max_accel_)) {
      outside = true;
      continue;
    }
    const bool stays = x[i] == last_[i] && value >= largest_[i];
    outside = outside || (stays && value > (i < 3 ? kSmallestRate : kSmallestAccel));
    largest_[i] = std::max(largest_[i], value);
  }
  return outside;
}

}  // namespace rio

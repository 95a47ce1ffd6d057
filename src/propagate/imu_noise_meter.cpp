// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/imu_noise_meter.hpp"

#include <algorithm>
#include <limits>

namespace rio {

namespace {

/// g_l of (E4): sum of squares of (1, -4, 6, -4, 1) convolved with the filters (E2) before it.
constexpr std::array kGain = {70.0, 19.25, 7.65625, 3.58203125, 1.760253906, 0.8762817383};

}  // namespace

ImuNoise ImuNoiseMeter::add(const ImuSample& sample) {
  double span = 0.0;
  if (count_ > 0.0) span = to_seconds(sample.time - newest_);
  if (span > kPause) reset();
  if (count_ > 0.0) interval_ += (span - interval_) / std::min(count_, kIntervals);
  newest_ = sample.time;
  count_ += 1.0;
  Vector6d x;
  x << sample.gyro_B, sample.accel_B;
  enter(0, x);
  ImuNoise q = density();
  const double lost = interval_ > 0.0 ? std::max(1.0, span / interval_) : 1.0;  // (E6)
  q.gyro *= lost;
  q.accel *= lost;
  return q;
}

void ImuNoiseMeter::enter(std::size_t l, const Vector6d& y) {
  Octave& o = octaves_[l];
  std::rotate(o.y.begin(), o.y.begin() + 1, o.y.end());
  o.y.back() = y;
  o.size = std::min(o.size + 1, 5);
  if (l > 0 && o.size == 5) {
    const Vector6d e = o.y[0] - 4.0 * o.y[1] + 6.0 * o.y[2] - 4.0 * o.y[3] + o.y[4];  // (E3)
    o.count += 1.0;
    const double weight = std::max(1.0 / o.count, interval(l) / (kMemory + interval(l)));
    o.gyro += weight * (e.head<3>().squaredNorm() / 3.0 - o.gyro);
    o.accel += weight * (e.tail<3>().squaredNorm() / 3.0 - o.accel);
  }
  o.odd = !o.odd;
  if (o.size >= 3 && o.odd && l + 1 < kOctaves) {
    enter(l + 1, 0.25 * (o.y[2] + 2.0 * o.y[3] + o.y[4]));  // (E2)
  }
}

ImuNoise ImuNoiseMeter::density() const {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  ImuNoise q{kInfinite, kInfinite};
  for (std::size_t l = 1; l < kOctaves; ++l) {
    const Octave& o = octaves_[l];
    if ((l > 1 && interval(l) > kLongest) || o.count < kEnough) break;
    q.gyro = std::min(q.gyro, interval_ * o.gyro / kGain[l]);
    q.accel = std::min(q.accel, interval_ * o.accel / kGain[l]);
  }
  return q.gyro < kInfinite ? q : ImuNoise{};
}

}  // namespace rio

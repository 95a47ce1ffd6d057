// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/imu_noise_meter.hpp"

#include <algorithm>
#include <limits>

namespace rio {

namespace {

/// g_l of (E4): sum of squares of (1, -4, 6, -4, 1) convolved with the filters (E2) before it.
constexpr std::array kGain = {70.0, 19.25, 7.65625, 3.58203125, 1.760253906, 0.8762817383};

/// Of octave 1, for the k-th value after an onset (E7).
constexpr std::array kOnsetGain = {0.1875, 2.875, 9.625, 16.375, 19.0625};

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
  for (Onset& onset : onsets_) onset.now = false;
  enter(0, x);
  const double lost = interval_ > 0.0 ? std::max(1.0, span / interval_) : 1.0;  // (E6)
  return {lost * density(kGyro), lost * density(kAccel)};
}

void ImuNoiseMeter::enter(std::size_t l, const Vector6d& y) {
  Octave& o = octaves_[l];
  std::rotate(o.y.begin(), o.y.begin() + 1, o.y.end());
  o.y.back() = y;
  o.size = std::min(o.size + 1, 5);
  if (l > 0 && o.size == 5) {
    const Vector6d e = o.y[0] - 4.0 * o.y[1] + 6.0 * o.y[2] - 4.0 * o.y[3] + o.y[4];  // (E3)
    const double least_weight = interval(l) / (kMemory + interval(l));
    for (const Sensor sensor : {kGyro, kAccel}) {
      const double square = e.segment<3>(3 * sensor).squaredNorm() / 3.0;
      if (l == 1) take(sensor, square, least_weight);
      if (l > 1) o.means[sensor].add(square, least_weight);
    }
  }
  o.odd = !o.odd;
  if (o.size >= 3 && o.odd && l + 1 < kOctaves) {
    enter(l + 1, 0.25 * (o.y[2] + 2.0 * o.y[3] + o.y[4]));  // (E2)
  }
}

void ImuNoiseMeter::Mean::add(double square, double least_weight) {
  count += 1.0;
  value += std::max(1.0 / count, least_weight) * (square - value);
}

void ImuNoiseMeter::take(std::size_t sensor, double square, double least_weight) {
  Onset& onset = onsets_[sensor];
  onset.recent += kRecent * (square - onset.recent);
  Mean& mean = octaves_[1].means[sensor];
  if (mean.count >= kEnough && onset.recent > kOnset * mean.value) {
    for (Octave& octave : octaves_) octave.means[sensor] = Mean{};
    onset.now = onset.begun = true;
    onset.values = 0;
  }
  double gain = kGain[1];
  if (onset.values < kDone) gain = kOnsetGain[onset.values++];
  if (onset.values == 2) mean = Mean{};  // the first was of two samples at most
  mean.add(square * kGain[1] / gain, least_weight);
}

double ImuNoiseMeter::density(std::size_t sensor) const {
  const Onset& onset = onsets_[sensor];
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  double q = kInfinite;
  for (std::size_t l = 1; l < kOctaves; ++l) {
    const Mean& mean = octaves_[l].means[sensor];
    const bool begun = l == 1 && onset.begun && mean.count > 0.0;
    if ((l > 1 && interval(l) > kLongest) || (mean.count < kEnough && !begun)) break;
    q = std::min(q, interval_ * mean.value / kGain[l]);
  }
  if (q == kInfinite) return 0.0;
  return onset.now ? (1.0 + kOnsetDelay) * q : q;
}

}  // namespace rio

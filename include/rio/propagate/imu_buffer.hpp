// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: IMU samples between the estimate and now, cut into steps between any two instants.
//
// A step spans two neighbouring samples, or a part of that span with linearly interpolated ends,
// and carries the mean of its two ends. Before the first sample, the first sample's value is held.
// The noise density measured up to each sample is stored with it.
#pragma once

#include <algorithm>

#include "rio/core/ring.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_noise_meter.hpp"
#include "rio/types.hpp"

namespace rio {

/// Constant-rate step of strapdown integration.
struct ImuStep {
  Time begin{0};
  Time end{0};
  Vector3d gyro_B = Vector3d::Zero();   ///< mean measured angular rate [rad/s]
  Vector3d accel_B = Vector3d::Zero();  ///< mean measured specific force [m/s^2]
  /// Length of the IMU gap (a pause longer than max_gap) that the step lies in, else 0 [s].
  double gap = 0.0;
  Vector3d gyro_change_B = Vector3d::Zero();   ///< half the change over two intervals [rad/s]
  Vector3d accel_change_B = Vector3d::Zero();  ///< same, specific force [m/s^2]
  double sample_interval = 1.0;                ///< between the samples at its ends [s]
  ImuNoise measured{};                         ///< noise density measured from the samples
};

/// Linear interpolation between two samples; `time` lies between their stamps.
ImuSample interpolate(const ImuSample& a, const ImuSample& b, Time time);

/// Ring of samples; a new one replaces the oldest when full. No allocation after construction.
class ImuBuffer {
 public:
  ImuBuffer(const TimingOptions& timing, const ImuOptions& imu)
      : samples_(static_cast<std::size_t>(timing.imu_buffer)),
        noise_(static_cast<std::size_t>(timing.imu_buffer)),
        max_gap_(from_seconds(imu.max_gap)) {}

  bool empty() const { return samples_.empty(); }
  bool full() const { return samples_.full(); }
  void clear() {
    samples_.clear();
    noise_.clear();
    meter_.reset();
  }
  std::size_t size() const { return samples_.size(); }
  const ImuSample& operator[](std::size_t i) const { return samples_[i]; }
  const ImuSample& newest() const { return samples_.back(); }

  /// Stamps must strictly increase: the caller checks.
  void push_back(const ImuSample& sample) {
    samples_.push_back(sample);
    noise_.push_back(meter_.add(sample));
  }
  /// Drops what is not needed to integrate from `time` on: keeps one sample at or before it.
  void forget_before(Time time);
  /// The pause between two samples is longer than ImuOptions::max_gap.
  bool is_gap(const ImuSample& a, const ImuSample& b) const { return b.time - a.time > max_gap_; }

  /// The measurement at `time`, interpolated; held constant outside the buffered span.
  ImuSample at(Time time) const;

  /// Calls f(const ImuStep&) for every step between `from` and `to`, in order. O(steps + log size).
  template <class F>
  void for_each_step(Time from, Time to, F&& f) const {
    if (samples_.empty() || from >= to) return;
    std::size_t i = first_after(from);
    if (i == 0) {  // the start lies before the IMU
      const ImuSample& first = samples_.front();
      const Time end = std::min(first.time, to);
      f(ImuStep{from, end, first.gyro_B, first.accel_B, gap(first.time - from)});
      i = 1;
    }
    for (; i < samples_.size() && samples_[i - 1].time < to; ++i) f(step(i, from, to));
  }

 private:
  /// The part of the step from sample i - 1 to i that lies between `from` and `to`.
  ImuStep step(std::size_t i, Time from, Time to) const;
  double gap(Time pause) const { return pause > max_gap_ ? to_seconds(pause) : 0.0; }
  /// For the step from sample i - 1 to i: half the change from sample i - 2 to i, or from i - 1 to
  /// i + 1 if i - 2 has been dropped; 0 if there are only two samples.
  Vector3d change(std::size_t i, Vector3d ImuSample::*value) const;
  /// Index of the first sample with a stamp later than `time`; size() if there is none.
  std::size_t first_after(Time time) const;

  Ring<ImuSample> samples_;
  Ring<ImuNoise> noise_;  ///< of the step that ends with each sample
  ImuNoiseMeter meter_;
  Time max_gap_;
};

}  // namespace rio

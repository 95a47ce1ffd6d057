// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/imu_buffer.hpp"

namespace rio {
ImuSample interpolate(const ImuSample& a, const ImuSample& b, Time time) {
  const double span = to_seconds(b.time - a.time);
  const double weight = span > 0.0 ? to_seconds(time - a.time) / span : 0.0;
  return {time, a.gyro_B + weight * (b.gyro_B - a.gyro_B),
          a.accel_B + weight * (b.accel_B - a.accel_B)};
}

void ImuBuffer::forget_before(Time time) {
  while (samples_.size() > 1 && samples_[1].time <= time) {
    samples_.pop_front();
    noise_.pop_front();
  }
}

ImuSample ImuBuffer::at(Time time) const {
  const std::size_t i = first_after(time);
  if (i > 0 && i < samples_.size()) return interpolate(samples_[i - 1], samples_[i], time);
  ImuSample held = i == 0 ? samples_.front() : samples_.back();
  held.time = time;
  return held;
}

ImuStep ImuBuffer::step(std::size_t i, Time from, Time to) const {
  const ImuSample& a = samples_[i - 1];
  const ImuSample& b = samples_[i];
  const ImuSample first = interpolate(a, b, std::max(a.time, from));
  const ImuSample last = interpolate(a, b, std::min(b.time, to));
  return {first.time,
          last.time,
          0.5 * (first.gyro_B + last.gyro_B),
          0.5 * (first.accel_B + last.accel_B),
          gap(b.time - a.time),
          change(i, &ImuSample::gyro_B),
          change(i, &ImuSample::accel_B),
          to_seconds(b.time - a.time),
          noise_[i]};
}

Vector3d ImuBuffer::change(std::size_t i, Vector3d ImuSample::*value) const {
  const std::size_t middle = i >= 2 ? i - 1 : i;
  if (middle + 1 >= samples_.size()) return Vector3d::Zero();
  return 0.5 * (samples_[middle + 1].*value - samples_[middle - 1].*value);
}

std::size_t ImuBuffer::first_after(Time time) const {
  std::size_t low = 0;
  std::size_t high = samples_.size();
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (samples_[middle].time > time) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

}  // namespace rio

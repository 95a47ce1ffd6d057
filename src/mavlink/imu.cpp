// SPDX-License-Identifier: BSD-3-Clause
#include "rio/mavlink/imu.hpp"

#include <algorithm>
#include <cmath>

#include "rio/mavlink/axes.hpp"

namespace rio::mavlink {
namespace {

constexpr std::uint64_t kMostMicroseconds = std::uint64_t{1} << 53;  // 285 years

template <class T>
Vector3d flu(const std::array<T, 3>& frd, double scale) {
  return scale * frd_to_flu({static_cast<double>(frd[0]), static_cast<double>(frd[1]),
                             static_cast<double>(frd[2])});
}

Time time_of(std::uint64_t microseconds) {
  return std::chrono::microseconds(std::min(microseconds, kMostMicroseconds));
}

bool is_finite(const std::array<float, 3>& values) {
  return std::isfinite(values[0]) && std::isfinite(values[1]) && std::isfinite(values[2]);
}

}  // namespace

std::optional<ImuSample> imu_sample(const HighresImu& message) {
  constexpr unsigned kAccelAndGyro = 0x3F;
  if ((message.fields_updated & kAccelAndGyro) != kAccelAndGyro) return std::nullopt;
  if (!is_finite(message.accel) || !is_finite(message.gyro)) return std::nullopt;
  return ImuSample{time_of(message.time_usec), flu(message.gyro, 1.0), flu(message.accel, 1.0)};
}

ImuSample imu_sample(const ScaledImu& message) {
  constexpr double kThousandth = 1e-3;
  return {std::chrono::milliseconds(message.time_boot_ms), flu(message.gyro, kThousandth),
          flu(message.accel, kThousandth * kStandardGravity)};
}

ImuSample imu_sample(const RawImu& message, const RawImuScale& scale) {
  return {time_of(message.time_usec), flu(message.gyro, scale.gyro),
          flu(message.accel, scale.accel)};
}

}  // namespace rio::mavlink

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/rest_detector.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

std::optional<RestModel::Measurement> RestDetector::observe(const DetectionList& scan, Time from,
                                                            Time to, const ImuBuffer& imu,
                                                            const Vector3d& gyro_bias) {
  if (!options_.frontend.detect_rest) return std::nullopt;
  const Statistics s = statistics(imu, from, to);
  const double duration = to_seconds(to - from);
  if (s.count < kMinSamples || duration > kLongestSpan || !is_still(s, duration, gyro_bias) ||
      !without_doppler(scan)) {
    reset();
    return std::nullopt;
  }
  still_ += duration;
  if (still_ < kDuration) return std::nullopt;
  const double noise = options_.imu.gyro_noise_density / std::sqrt(duration);
  return RestModel::Measurement{s.mean.head<3>(), kStandingVelocity,
                                std::max(noise, kSmallestRate)};
}

void RestDetector::Statistics::add(const ImuSample& sample) {
  Vector6d x;
  x << sample.gyro_B, sample.accel_B;
  count += 1.0;
  const Vector6d delta = x - mean;
  mean += delta / count;
  squares += delta.cwiseProduct(x - mean);
}

RestDetector::Statistics RestDetector::statistics(const ImuBuffer& imu, Time from, Time to) {
  Statistics s;
  for (std::size_t i = 0; i < imu.size(); ++i) {
    if (imu[i].time > from && imu[i].time <= to) s.add(imu[i]);
  }
  return s;
}

bool RestDetector::is_still(const Statistics& s, double duration, const Vector3d& gyro_bias) const {
  const double root_rate = std::sqrt(s.count / duration);
  const double gyro = std::max(kSpread * options_.imu.gyro_noise_density * root_rate, kGyroFloor);
  const double accel =
      std::max(kSpread * options_.imu.accel_noise_density * root_rate, kAccelFloor);
  return s.deviation().head<3>().maxCoeff() < gyro &&                  // (E1)
         s.deviation().tail<3>().maxCoeff() < accel &&                 //
         (s.mean.head<3>() - gyro_bias).cwiseAbs().maxCoeff() < gyro;  // (E2)
}

bool RestDetector::without_doppler(const DetectionList& scan) {  // (E3)
  std::size_t still = 0;
  for (const Detection& d : scan.items) {
    still += std::abs(d.range_rate) < kDopplerSigmas * d.sigma_doppler ? 1 : 0;
  }
  return still >= kMinDetections &&
         static_cast<double>(still) > kShare * static_cast<double>(scan.items.size());
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/barometer.hpp"

#include <algorithm>
#include <cmath>

namespace rio::io {

std::optional<double> BarometricScale::height(const BaroSample& sample) const {
  if (!(std::isfinite(sample.pressure) && sample.pressure > 0.0)) return std::nullopt;
  return -kPressureScale * std::log(sample.pressure) - zero;
}

BarometricHeights barometric_heights(const std::vector<BaroSample>& baro) {
  constexpr double kLeast = 0.01;  // no barometer is better [m]
  constexpr double kZero = 2.0;    // the height there is zero [s]
  BarometricScale scale;
  Time first{0};
  double sum = 0.0;
  double count = 0.0;
  for (const BaroSample& sample : baro) {
    const std::optional<double> height = scale.height(sample);  // zero is not yet known
    if (!height) continue;
    if (count == 0.0) first = sample.time;
    if (to_seconds(sample.time - first) > kZero) continue;
    sum += *height;
    count += 1.0;
  }
  if (count > 0.0) scale.zero = sum / count;
  BarometricHeights out;
  double squares = 0.0;
  double pairs = 0.0;
  for (const BaroSample& sample : baro) {
    const std::optional<double> height = scale.height(sample);
    if (!height) continue;
    if (!out.samples.empty()) {
      const double change = *height - out.samples.back().height;
      squares += change * change;
      pairs += 1.0;
    }
    out.samples.push_back({sample.time, *height});
  }
  out.sigma = std::max(kLeast, std::sqrt(0.5 * squares / std::max(1.0, pairs)));
  return out;
}

}  // namespace rio::io

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/barometer.hpp"

#include <algorithm>
#include <cmath>

namespace rio::io {

std::optional<double> BarometricScale::height(const BaroSample& sample) const {
  if (!(std::isfinite(sample.pressure) && sample.pressure > 0.0)) return std::nullopt;
  return -kPressureScale * std::log(sample.pressure) - zero;
}

BarometricScale barometric_scale(const std::function<void(const UseBaroSample&)>& each_sample) {
  constexpr double kLeast = 0.01;  // no barometer is better [m]
  constexpr double kZero = 2.0;    // the height there is zero [s]
  BarometricScale out;
  double sum = 0.0;
  double count = 0.0;
  Time first{0};
  each_sample([&](const BaroSample& sample) {
    const std::optional<double> height = out.height(sample);  // zero is not yet known
    if (!height) return;
    if (!out.any) first = sample.time;
    out.any = true;
    if (to_seconds(sample.time - first) > kZero) return;
    sum += *height;
    count += 1.0;
  });
  if (out.any) out.zero = sum / count;
  std::optional<double> last;
  double squares = 0.0;
  double pairs = 0.0;
  each_sample([&](const BaroSample& sample) {
    const std::optional<double> height = out.height(sample);
    if (!height) return;
    if (last) {
      squares += (*height - *last) * (*height - *last);
      pairs += 1.0;
    }
    last = height;
  });
  out.sigma = std::max(kLeast, std::sqrt(0.5 * squares / std::max(1.0, pairs)));
  return out;
}

BarometricHeights barometric_heights(const std::vector<BaroSample>& baro) {
  const BarometricScale scale = barometric_scale([&baro](const UseBaroSample& use) {
    for (const BaroSample& sample : baro) use(sample);
  });
  BarometricHeights out;
  for (const BaroSample& sample : baro) {
    if (const auto height = scale.height(sample)) out.samples.push_back({sample.time, *height});
  }
  out.sigma = scale.sigma;
  return out;
}

}  // namespace rio::io

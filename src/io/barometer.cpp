// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/barometer.hpp"

#include <algorithm>
#include <cmath>

namespace rio::io {

BarometricHeights barometric_heights(const std::vector<BaroSample>& baro) {
  constexpr double kLeast = 0.01;  // no barometer is better [m]
  constexpr double kZero = 2.0;    // the height there is zero [s]
  BarometricHeights out;
  double sum = 0.0;
  double count = 0.0;
  Time first{0};
  for (const BaroSample& sample : baro) {
    if (!(std::isfinite(sample.pressure) && sample.pressure > 0.0)) continue;
    if (out.samples.empty()) first = sample.time;
    out.samples.push_back({sample.time, -kPressureScale * std::log(sample.pressure)});
    if (to_seconds(sample.time - first) > kZero) continue;
    sum += out.samples.back().height;
    count += 1.0;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < out.samples.size(); ++i) {
    out.samples[i].height -= sum / count;
    const double change = i > 0 ? out.samples[i].height - out.samples[i - 1].height : 0.0;
    squares += change * change;
  }
  const double pairs = std::max(1.0, static_cast<double>(out.samples.size()) - 1.0);
  out.sigma = std::max(kLeast, std::sqrt(0.5 * squares / pairs));
  return out;
}

}  // namespace rio::io

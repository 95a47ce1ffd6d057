// SPDX-License-Identifier: BSD-3-Clause
// The Doppler grid of a recording whose sensor.yaml does not tell it.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "rio/types.hpp"

namespace rio::io {

/// Step of the Doppler [m/s] if nearly all values are multiples of the smallest one, as those of an
/// FFT are; nothing if they are not, or if there are too few to tell.
inline std::optional<double> doppler_grid(const std::vector<RadarScan>& scans) {
  constexpr double kNoise = 1e-3;     // rounding of a recorded number [m/s]
  constexpr double kTolerance = 0.1;  // of a step; a random value has a chance of 0.2 to be so near
  constexpr int kEnough = 200;
  const auto each = [&scans](const auto& f) {
    for (const RadarScan& scan : scans) {
      for (const RadarDetection& d : scan.detections) {
        if (std::abs(d.range_rate) > kNoise) f(std::abs(d.range_rate));
      }
    }
  };
  double smallest = std::numeric_limits<double>::infinity();
  each([&](double speed) { smallest = std::min(smallest, speed); });
  int count = 0;
  int on_grid = 0;
  int beyond_first = 0;
  double sum = 0.0;
  double multiples = 0.0;
  each([&](double speed) {
    ++count;
    const double multiple = std::round(speed / smallest);
    if (std::abs(speed / smallest - multiple) > kTolerance) return;
    ++on_grid;
    beyond_first += multiple > 1.0 ? 1 : 0;
    sum += speed;
    multiples += multiple;
  });
  if (count < kEnough || on_grid < 0.99 * count || beyond_first < kEnough / 2) return std::nullopt;
  return sum / multiples;
}

}  // namespace rio::io

// SPDX-License-Identifier: BSD-3-Clause
// The Doppler grid of a recording whose sensor.yaml does not have it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "rio/types.hpp"

namespace rio::io {

/// Step of the Doppler [m/s] if nearly all values are multiples of the smallest one, as from an
/// FFT; empty if they are not, or if there are too few. All values are needed twice: those of a
/// short recording are stored.
class DopplerGrid {
 public:
  void add(const RadarScan& scan) {
    for (const RadarDetection& d : scan.detections) {
      const double speed = std::abs(d.range_rate);
      if (!(speed > kNoise)) continue;
      smallest_ = std::min(smallest_, speed);
      if (count_++ < kKept) kept_.push_back(speed);
    }
  }

  /// @param each_scan calls its argument with all scans again, in the same order, until that
  /// returns false; used for long recordings only
  template <class EachScan>
  std::optional<double> step(EachScan&& each_scan) {
    if (count_ == kept_.size()) {
      for (const double speed : kept_) take(speed);
    } else {
      each_scan([this](const RadarScan& scan) {
        for (const RadarDetection& d : scan.detections) {
          if (std::abs(d.range_rate) > kNoise) take(std::abs(d.range_rate));
        }
        return may_be_grid(off_grid_);
      });
    }
    if (count_ < kEnough || !may_be_grid(count_ - on_grid_) || beyond_first_ < kEnough / 2) {
      return std::nullopt;
    }
    return sum_ / multiples_;
  }

 private:
  static constexpr double kNoise = 1e-3;  // rounding of a recorded number [m/s]
  static constexpr std::size_t kEnough = 200;
  static constexpr std::size_t kKept = 1 << 16;

  bool may_be_grid(std::size_t off_grid) const {
    return static_cast<double>(count_ - off_grid) >= 0.99 * static_cast<double>(count_);
  }

  void take(double speed) {
    constexpr double kTolerance =
        0.1;  // of a step; a random value has a chance of 0.2 to be so close
    const double multiple = std::round(speed / smallest_);
    if (std::abs(speed / smallest_ - multiple) > kTolerance) {
      ++off_grid_;
      return;
    }
    ++on_grid_;
    beyond_first_ += multiple > 1.0 ? 1 : 0;
    sum_ += speed;
    multiples_ += multiple;
  }

  double smallest_ = std::numeric_limits<double>::infinity();
  std::size_t count_ = 0;
  std::vector<double> kept_;  ///< the first of the values
  std::size_t on_grid_ = 0;
  std::size_t off_grid_ = 0;
  std::size_t beyond_first_ = 0;
  double sum_ = 0.0;
  double multiples_ = 0.0;
};

}  // namespace rio::io

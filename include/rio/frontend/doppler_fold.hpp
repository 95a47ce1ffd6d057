// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: Doppler ambiguity (aliasing, "folding"): the radar reports a range rate modulo 2 v_max.
//
// (E1) wrap(x) = x - 2 v_max round(x / (2 v_max)), in +-v_max
// (E2) unfolding: of all rates d + 2 k v_max the one nearest to the expected rate,
//      expected + wrap(d - expected)
// (E3) the fold is unique if 3 sigma < v_max, sigma that of d - expected: then at most one of the
//      rates lies within three sigmas
#pragma once

#include <cmath>
#include <limits>

#include "rio/options.hpp"

namespace rio {

class DopplerFold {
 public:
  DopplerFold() = default;  ///< no ambiguity
  /// @param max_doppler v_max [m/s]; 0 = no ambiguity
  explicit DopplerFold(double max_doppler) : limit_(max_doppler > 0.0 ? max_doppler : kNone) {}

  /// Infinite if there is no ambiguity [m/s].
  double limit() const { return limit_; }
  bool ambiguous() const { return std::isfinite(limit_); }
  double wrap(double difference) const {  // (E1)
    if (std::abs(difference) < limit_ || !ambiguous()) return difference;
    return difference - 2.0 * limit_ * std::round(difference / (2.0 * limit_));
  }
  double nearest(double range_rate, double expected) const {  // (E2)
    return ambiguous() ? expected + wrap(range_rate - expected) : range_rate;
  }
  /// @param variance of the difference of measured and expected rate [m^2/s^2]
  bool is_unique(double variance) const {  // (E3)
    constexpr double kSigmas = 3.0;
    return kSigmas * std::sqrt(variance) < limit_;
  }

  /// The fold of range rates that have been divided by `scale`, as by an estimated Doppler scale.
  DopplerFold divided(double scale) const { return DopplerFold(limit_ / scale); }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  double limit_ = kNone;
};

/// The fold of one radar; no ambiguity if unwrap_doppler is off.
inline DopplerFold doppler_fold(const Options& options, std::size_t radar) {
  return DopplerFold(options.frontend.unwrap_doppler ? options.radar_of(radar).max_doppler : 0.0);
}
/// The fold with the smallest v_max of all radars: where it is unique, so are the others.
inline DopplerFold tightest_fold(const Options& options) {
  DopplerFold out;
  for (std::size_t r = 0; r < options.radars(); ++r) {
    const DopplerFold fold = doppler_fold(options, r);
    if (fold.limit() < out.limit()) out = fold;
  }
  return out;
}

}  // namespace rio

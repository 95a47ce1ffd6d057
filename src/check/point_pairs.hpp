// SPDX-License-Identifier: BSD-3-Clause
// Pairs of points of two scans, and how sure they make one of two hypotheses: (E3) of
// points_check.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "check/scans.hpp"
#include "rio/types.hpp"

namespace rio::check {

inline constexpr double kRangeBin = 0.05;  ///< sigma_r of (E1) [m]

/// The number of pairs per block that support only one or the other of two hypotheses.
struct Support {
  static constexpr std::size_t kFewestBlocks = 8;  ///< chance of a t of 3 below 1 in 100

  std::vector<double> first;
  std::vector<double> second;

  void add(std::size_t block, bool supports_first, bool supports_second) {
    if (first.size() <= block) {
      first.resize(block + 1);
      second.resize(block + 1);
    }
    first[block] += supports_first ? 1.0 : 0.0;
    second[block] += supports_second ? 1.0 : 0.0;
  }
  double of_first() const { return std::accumulate(first.begin(), first.end(), 0.0); }
  double of_second() const { return std::accumulate(second.begin(), second.end(), 0.0); }
  double lead() const { return of_first() - of_second(); }
  /// (E3), in favour of the first; 0 with too few blocks.
  double sure() const {
    double mean = 0.0;
    double square = 0.0;
    double n = 0.0;
    for (std::size_t b = 0; b < first.size(); ++b) {
      if (first[b] + second[b] == 0.0) continue;
      const double difference = first[b] - second[b];
      mean += difference;
      square += difference * difference;
      n += 1.0;
    }
    if (n < static_cast<double>(kFewestBlocks)) return 0.0;
    mean /= n;
    const double variance = (square / n - mean * mean) / (n - 1.0);
    return mean / std::sqrt(std::max(variance, 1e-12));
  }
  bool is_sure() const {
    constexpr double kSure = 3.0;
    return sure() > kSure;
  }
  /// With too few blocks for sure(): whether many pairs, in every block, favour the first.
  bool leans() const {
    constexpr double kLead = 1.5;           // to one, of the pairs
    constexpr double kFewestPairs = 300.0;  // a few reflectors for seconds
    double n = 0.0;
    for (std::size_t b = 0; b < first.size(); ++b) {
      if (first[b] < second[b]) return false;
      n += first[b] + second[b] > 0.0 ? 1.0 : 0.0;
    }
    return n > 1.0 && n < static_cast<double>(kFewestBlocks) &&
           of_first() + of_second() > kFewestPairs && of_first() > kLead * of_second();
  }
  Support reversed() const { return {second, first}; }
};

/// Time between two scans, of any two stamps [s].
inline double between(const ScanView& from, const ScanView& to) {
  return to_seconds(to.time) - to_seconds(from.time);
}

/// Calls use(scan, later scan, dt) for the scans up to half a second after this one.
template <typename Use>
void each_later_scan(const Scans& scans, std::size_t i, Use&& use) {
  constexpr double kLongest = 0.5;  // [s]
  for (std::size_t j = i + 1; j < scans.size(); ++j) {
    const double dt = between(scans[i], scans[j]);
    if (!(dt > 0.0) || dt > kLongest) return;
    use(scans[i], scans[j], dt);
  }
}

/// Calls use(scan, later scan, dt, block); subsamples the scans if there are many points.
template <typename Use>
void each_pair_of_scans(const Scans& scans, Use&& use) {
  constexpr double kMost = 1e6;   // pairs of points
  constexpr double kBlock = 2.0;  // [s]
  double pairs = 0.0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    each_later_scan(scans, i, [&](const ScanView& from, const ScanView& to, double) {
      pairs += static_cast<double>(from.detections.size() * to.detections.size());
    });
  }
  const auto stride = static_cast<std::size_t>(1.0 + pairs / kMost);
  std::size_t block = 0;
  std::size_t begin = 0;  // of the block
  for (std::size_t i = 0; i < scans.size(); i += stride) {
    if (std::abs(between(scans[begin], scans[i])) > kBlock) {
      begin = i;
      ++block;
    }
    each_later_scan(scans, i, [&](const ScanView& from, const ScanView& to, double dt) {
      use(from, to, dt, block);
    });
  }
}

}  // namespace rio::check

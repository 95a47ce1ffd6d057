// SPDX-License-Identifier: BSD-3-Clause
#include "live/latencies.hpp"

#include <algorithm>
#include <cmath>

namespace rio::live {

double Latencies::quantile(double share) const {
  if (seconds_.empty()) return 0.0;
  std::vector<float> sorted = seconds_;
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto at = sorted.begin() + std::lround(place);
  std::nth_element(sorted.begin(), at, sorted.end());
  return static_cast<double>(*at);
}

}  // namespace rio::live

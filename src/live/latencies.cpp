// SPDX-License-Identifier: BSD-3-Clause
#include "live/latencies.hpp"

#include <algorithm>

namespace rio::live {

double Latencies::quantile(double share) const {
  if (seconds_.empty()) return 0.0;
  std::vector<float> sorted = seconds_;
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(place + 0.5);
  std::nth_element(sorted.begin(), at, sorted.end());
  return static_cast<double>(*at);
}

}  // namespace rio::live

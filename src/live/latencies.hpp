// SPDX-License-Identifier: BSD-3-Clause
// Latencies of the estimates, as quantiles.
#pragma once

#include <cstddef>
#include <vector>

#include "rio/types.hpp"

namespace rio::live {

class Latencies {
 public:
  void add(Time latency) { seconds_.push_back(static_cast<float>(to_seconds(latency))); }
  std::size_t count() const { return seconds_.size(); }
  /// @param share 0.5 the median
  /// @return [s]; 0 if there is none
  double quantile(double share) const;

 private:
  std::vector<float> seconds_;
};

}  // namespace rio::live

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

namespace rio::check {

/// The value below which the share lies; NaN of nothing. The values are put into another order.
inline double quantile_of(std::vector<double>* values, double share) {
  if (values->empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::nth_element(values->begin(), values->begin() + at, values->end());
  return (*values)[static_cast<std::size_t>(at)];
}

inline double quantile(std::vector<double> values, double share) {
  return quantile_of(&values, share);
}

inline double median(std::vector<double> values) {
  return quantile_of(&values, 0.5);
}

}  // namespace rio::check

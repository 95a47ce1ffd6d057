// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace rio::check {

/// A unit that data may be in.
struct Unit {
  const char* name;
  double factor;  ///< to that of SI
};

/// Possible units of a Doppler, and their factor relative to [m/s].
struct DopplerUnit {
  const char* name;
  double scale;
};
inline constexpr std::array<DopplerUnit, 5> kDopplerUnits = {
    {{"in km/h", 3.6},
     {"in mph", 2.2369},
     {"twice the range rate (or in knots: 0.5144 in place of 0.5)", 2.0},
     {"in cm/s", 100.0},
     {"half the range rate", 0.5}}};

/// The quantile of this share; NaN without values. Reorders the values.
inline double quantile_of(std::vector<double>* values, double share) {
  if (values->empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::nth_element(values->begin(), values->begin() + at, values->end());
  return (*values)[static_cast<std::size_t>(at)];
}

inline double median(std::vector<double> values) {
  return quantile_of(&values, 0.5);
}

/// Whether single and double steps of a grid alternate, with next to nothing longer: a period in
/// between, cut to the grid. Steps that are lost by chance would also be lost in pairs.
inline bool alternates(const std::vector<double>& periods, double step) {
  constexpr double kFewest = 10.0;  // pairs that chance would have lost
  constexpr double kRare = 0.2;     // of these
  double twice = 0.0;
  double other = 0.0;
  for (const double period : periods) {
    const double steps = period / step;
    twice += std::abs(steps - 2.0) < 0.2 ? 1.0 : 0.0;
    other += steps > 1.2 && std::abs(steps - 2.0) >= 0.2 ? 1.0 : 0.0;
  }
  const double by_chance = twice * twice / static_cast<double>(periods.size());
  return by_chance > kFewest && other < kRare * by_chance;
}

/// A longer period is a gap.
/// @param known period of the sensor, if configured: steps of this length do not alternate [s]
inline double longest_usual(const std::vector<double>& periods, std::optional<double> known) {
  const double step = median(periods);
  const bool is_known = known && std::abs(*known / step - 1.0) < 0.1;
  return (!is_known && alternates(periods, step) ? 2.4 : 1.6) * step;
}

/// The usual period of stamps that may be cut to a grid, of which some are missing: the median of
/// 30, 30 and 40 ms is not their rate. A gap counts as so many periods of the mean of the others.
/// @param most longest_usual() of them
inline double usual_period(const std::vector<double>& periods, double most) {
  double sum = 0.0;
  double count = 0.0;
  for (const double period : periods) {
    sum += period <= most ? period : 0.0;
    count += period <= most ? 1.0 : 0.0;
  }
  const double usual = sum / count;
  sum = 0.0;
  count = 0.0;
  for (const double period : periods) {
    sum += period;
    count += period <= most ? 1.0 : std::max(1.0, std::round(period / usual));
  }
  return sum / count;
}

/// The same of a value of each item that is finite.
/// @param value a member, or a function of an item
template <typename Items, typename Value>
double quantile_of(const Items& items, Value&& value, double share) {
  std::vector<double> values;
  values.reserve(items.size());
  for (const auto& item : items) {
    if (const double x = std::invoke(value, item); std::isfinite(x)) values.push_back(x);
  }
  return quantile_of(&values, share);
}

}  // namespace rio::check

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace rio::check {

/// The quantile of this share; NaN without values. Reorders the values.
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

/// The usual period of stamps that may be cut to a grid, of which some are missing: the median of
/// 30, 30 and 40 ms is not their rate. A gap counts as so many periods of the mean of the others.
inline double usual_period(const std::vector<double>& periods) {
  const double most = 1.6 * median(periods);
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
    count += std::max(1.0, std::round(period / usual));
  }
  return sum / count;
}

/// The same quantile for many values, without copying them: digit by digit. If some are NaN, a copy
/// is made.
/// @param each calls its argument with all values; called several times
template <typename Each>
double quantile_of_each(Each&& each, double share) {
  constexpr int kBits = 16;  // of a digit
  constexpr std::uint64_t kDigits = std::uint64_t{1} << kBits;
  std::size_t count = 0;
  bool any_nan = false;
  each([&](double value) {
    ++count;
    any_nan = any_nan || std::isnan(value);
  });
  if (count == 0) return std::numeric_limits<double>::quiet_NaN();
  if (any_nan) {
    std::vector<double> values;
    values.reserve(count);
    each([&values](double value) { values.push_back(value); });
    return quantile_of(&values, share);
  }
  auto rank = static_cast<std::size_t>(share * static_cast<double>(count - 1));
  std::uint64_t found = 0;  // the digits so far, of numbers in the order of the values
  std::vector<std::uint32_t> with_digit(kDigits);
  for (int shift = 64 - kBits; shift >= 0; shift -= kBits) {
    std::fill(with_digit.begin(), with_digit.end(), 0U);
    const std::uint64_t known = shift + kBits < 64 ? ~std::uint64_t{0} << (shift + kBits) : 0;
    each([&](double value) {
      constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
      auto bits = std::bit_cast<std::uint64_t>(value + 0.0);  // no negative zero
      bits = (bits & kSign) != 0 ? ~bits : bits | kSign;
      if ((bits & known) == found) ++with_digit[(bits >> shift) % kDigits];
    });
    std::uint64_t digit = 0;
    while (rank >= with_digit[digit]) rank -= with_digit[digit++];
    found |= digit << shift;
  }
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return std::bit_cast<double>((found & kSign) != 0 ? found & ~kSign : ~found);
}

}  // namespace rio::check

// SPDX-License-Identifier: BSD-3-Clause
#include "decimal.hpp"

#include <limits>
#include <string>

namespace rio::io {

std::optional<std::int64_t> scaled_by_1e9(std::string_view text) {
  text = without_plus(text);
  const bool negative = !text.empty() && text[0] == '-';
  if (negative) text.remove_prefix(1);
  std::int64_t exponent = 0;
  if (const std::size_t e = text.find_first_of("eE"); e != std::string_view::npos) {
    const auto parsed = number_of<std::int64_t>(text.substr(e + 1));
    if (!parsed || *parsed < -1000 || *parsed > 1000) return std::nullopt;
    exponent = *parsed;
    text = text.substr(0, e);
  }
  std::string digits;
  std::int64_t before_point = -1;
  for (const char c : text) {
    if (c == '.' && before_point < 0) {
      before_point = static_cast<std::int64_t>(digits.size());
    } else if (c >= '0' && c <= '9') {
      digits += c;
    } else {
      return std::nullopt;
    }
  }
  if (digits.empty()) return std::nullopt;
  if (before_point < 0) before_point = static_cast<std::int64_t>(digits.size());
  const std::int64_t whole_digits = before_point + exponent + 9;

  std::int64_t value = 0;
  for (std::int64_t i = 0; i < whole_digits; ++i) {
    const bool given = i < static_cast<std::int64_t>(digits.size());
    const int digit = given ? digits[static_cast<std::size_t>(i)] - '0' : 0;
    if (value > (std::numeric_limits<std::int64_t>::max() - 10) / 10) return std::nullopt;
    value = value * 10 + digit;
  }
  const bool has_next =
      whole_digits >= 0 && whole_digits < static_cast<std::int64_t>(digits.size());
  if (has_next && digits[static_cast<std::size_t>(whole_digits)] >= '5') ++value;
  return negative ? -value : value;
}

}  // namespace rio::io

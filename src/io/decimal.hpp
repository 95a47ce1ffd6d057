// SPDX-License-Identifier: BSD-3-Clause
// Numbers and quaternions of text files.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>

#include "rio/types.hpp"

namespace rio::io {

/// Without these characters around it.
inline std::string_view trimmed(std::string_view text, const char* around = " \t") {
  const std::size_t begin = text.find_first_not_of(around);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(around) - begin + 1);
}

/// Without a leading plus, which std::from_chars does not take.
inline std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  return text;
}

/// The whole of `text` as a number of its type, which has no leading plus.
template <class Number>
std::optional<Number> plain_number_of(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The same, after a leading plus.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  return plain_number_of<Number>(without_plus(text));
}

/// A decimal number, exponent allowed, times 1e9, rounded half away from zero; without floating
/// point.
std::optional<std::int64_t> scaled_by_1e9(std::string_view text);

/// Normalised if its length is within 1 % of one, else empty (also for NaN). A quaternion that is
/// unit to rounding is unchanged, so that one written in full precision reads back to the bit.
inline std::optional<Quaternion> unit_quaternion(double w, double x, double y, double z) {
  const Quaternion q(w, x, y, z);
  const double error = std::abs(q.norm() - 1.0);
  if (!(error < 0.01)) return std::nullopt;
  if (error < 1e-12) return q;
  return Quaternion(q.normalized());
}

}  // namespace rio::io

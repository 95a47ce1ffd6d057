// SPDX-License-Identifier: BSD-3-Clause
// Decimal numbers of text files.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>

namespace rio::io {

/// Without a leading plus, which std::from_chars does not take.
inline std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  return text;
}

/// The whole of `text` as a number of its type.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  text = without_plus(text);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// A decimal number, exponent allowed, times 1e9, rounded half away from zero; without floating
/// point.
std::optional<std::int64_t> scaled_by_1e9(std::string_view text);

}  // namespace rio::io

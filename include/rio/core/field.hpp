// SPDX-License-Identifier: BSD-3-Clause
// A table of fields: what a loop over the members of a struct needs to validate, read, write and
// document them. C++17.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

#include "rio/types.hpp"

namespace rio {

/// Who sets a field: the user, who knows the sensors, or the designer of the algorithm.
enum class Layer : std::uint8_t { kUser, kAlgorithm };

/// One row of the table; [min, max] is the allowed range (numbers only), `unit` is SI or "".
struct FieldInfo {
  const char* key;
  const char* unit;
  const char* doc;
  double min;
  double max;
  Layer layer = Layer::kUser;
};

namespace field_detail {

/// Shortest decimal text that reads back as the same number.
template <class Number>
std::string to_text(Number value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return std::string(buffer, end);
}

}  // namespace field_detail

/// What is wrong with a value, e.g. "update.max_clones = 30 is outside [0, 20]"; empty if valid.
inline std::string field_error(const FieldInfo& info, double value) {
  if (value >= info.min && value <= info.max) return {};
  using field_detail::to_text;
  const std::string unit = *info.unit == '\0' ? "" : std::string(" ") + info.unit;
  return std::string(info.key) + " = " + to_text(value) + " is outside [" + to_text(info.min) +
         ", " + to_text(info.max) + "]" + unit;
}
inline std::string field_error(const FieldInfo& info, std::uint64_t value) {
  return field_error(info, static_cast<double>(value));
}
inline std::string field_error(const FieldInfo& info, int value) {
  return field_error(info, static_cast<double>(value));
}
inline std::string field_error(const FieldInfo&, bool) {
  return {};
}
inline std::string field_error(const FieldInfo&, const std::string&) {
  return {};
}
inline std::string field_error(const FieldInfo& info, const Vector3d& value) {
  for (int i = 0; i < 3; ++i) {
    std::string error = field_error(info, value[i]);
    if (!error.empty()) return error;
  }
  return {};
}
inline std::string field_error(const FieldInfo& info, const Quaternion& value) {
  if (std::abs(value.norm() - 1.0) < 1e-6) return {};
  return std::string(info.key) + " is not a unit quaternion";
}

}  // namespace rio

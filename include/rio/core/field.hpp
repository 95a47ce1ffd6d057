// SPDX-License-Identifier: BSD-3-Clause
// A table of fields: what a loop over the members of a struct needs to validate, read, write and
// document them. C++17.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>

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

/// What is wrong with a value, e.g. "update.max_clones = 30 is outside [0, 20]"; empty if valid.
template <class Value>
std::string field_error([[maybe_unused]] const FieldInfo& info,
                        [[maybe_unused]] const Value& value) {
  if constexpr (std::is_same_v<Value, Vector3d>) {
    for (const double element : value) {
      std::string error = field_error(info, element);
      if (!error.empty()) return error;
    }
  } else if constexpr (std::is_same_v<Value, Quaternion>) {
    if (!(std::abs(value.norm() - 1.0) < 1e-6)) {
      return std::string(info.key) + " is not a unit quaternion";
    }
  } else if constexpr (!std::is_same_v<Value, bool> && !std::is_same_v<Value, std::string>) {
    const auto number = static_cast<double>(value);
    if (number >= info.min && number <= info.max) return {};
    const auto text = [](double x) {  // the shortest that reads back as the same number
      char buffer[32];
      return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr);
    };
    const std::string unit = *info.unit == '\0' ? "" : std::string(" ") + info.unit;
    return std::string(info.key) + " = " + text(number) + " is outside [" + text(info.min) + ", " +
           text(info.max) + "]" + unit;
  }
  return {};
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/units.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>
#include <system_error>

#include "decimal.hpp"

namespace rio::io {

namespace {

/// A factor to SI and the exponents of m, s, rad, dB, doubled so that sqrt() stays an integer.
struct Unit {
  double factor = 1.0;
  std::array<int, 4> half_exponents{};
};

struct NamedUnit {
  std::string_view name;
  double factor;
  std::array<int, 4> exponents;
};

constexpr std::array<NamedUnit, 25> kUnits = {{
    {"m", 1.0, {1, 0, 0, 0}},
    {"km", 1e3, {1, 0, 0, 0}},
    {"cm", 1e-2, {1, 0, 0, 0}},
    {"mm", 1e-3, {1, 0, 0, 0}},
    {"um", 1e-6, {1, 0, 0, 0}},
    {"ft", 0.3048, {1, 0, 0, 0}},
    {"s", 1.0, {0, 1, 0, 0}},
    {"ms", 1e-3, {0, 1, 0, 0}},
    {"us", 1e-6, {0, 1, 0, 0}},
    {"ns", 1e-9, {0, 1, 0, 0}},
    {"min", 60.0, {0, 1, 0, 0}},
    {"h", 3600.0, {0, 1, 0, 0}},
    {"rad", 1.0, {0, 0, 1, 0}},
    {"mrad", 1e-3, {0, 0, 1, 0}},
    {"deg", kDegree, {0, 0, 1, 0}},
    {"mdeg", 1e-3 * kDegree, {0, 0, 1, 0}},
    {"rpm", 6.0 * kDegree, {0, -1, 1, 0}},
    {"Hz", 1.0, {0, -1, 0, 0}},
    {"kHz", 1e3, {0, -1, 0, 0}},
    {"g", kStandardGravity, {1, -2, 0, 0}},
    {"mg", 1e-3 * kStandardGravity, {1, -2, 0, 0}},
    {"ug", 1e-6 * kStandardGravity, {1, -2, 0, 0}},
    {"dB", 1.0, {0, 0, 0, 1}},
    {"%", 1e-2, {0, 0, 0, 0}},
    {"1", 1.0, {0, 0, 0, 0}},
}};

[[noreturn]] void unknown(std::string_view text) {
  throw std::invalid_argument("unknown unit \"" + std::string(text) + "\"");
}

/// One factor such as "m", "s^2" or "sqrt(Hz)", times `sign` in the exponent.
void multiply(std::string_view text, int sign, Unit* product) {
  text = trimmed(text);
  int doubled_power = 2;
  std::string_view name = text;
  if (name.starts_with("sqrt(") && name.ends_with(')')) {
    name = name.substr(5, name.size() - 6);
    doubled_power = 1;
  } else if (const std::size_t caret = name.find('^'); caret != std::string_view::npos) {
    const auto power = plain_number_of<int>(name.substr(caret + 1));
    if (!power || std::abs(*power) > 9) unknown(text);
    doubled_power = 2 * *power;
    name = name.substr(0, caret);
  }
  doubled_power *= sign;
  for (const NamedUnit& unit : kUnits) {
    if (unit.name != name) continue;
    product->factor *= std::pow(unit.factor, 0.5 * doubled_power);
    for (std::size_t i = 0; i < unit.exponents.size(); ++i) {
      product->half_exponents[i] += unit.exponents[i] * doubled_power;
    }
    return;
  }
  unknown(text);
}

Unit parse_unit(std::string_view text) {
  Unit product;
  if (text.empty()) return product;
  int sign = 1;
  while (true) {
    const std::size_t end = text.find_first_of("*/");
    multiply(text.substr(0, end), sign, &product);
    if (end == std::string_view::npos) return product;
    sign = text[end] == '/' ? -1 : 1;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

double parse_quantity(std::string_view text, std::string_view si_unit) {
  const std::string_view whole = trimmed(text);
  const std::string_view digits = without_plus(whole);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{}) {
    throw std::invalid_argument("not a number: \"" + std::string(whole) + "\"");
  }
  const std::string_view unit_text =
      trimmed(digits.substr(static_cast<std::size_t>(end - digits.data())));
  if (unit_text.empty()) return value;
  const Unit unit = parse_unit(unit_text);
  if (unit.half_exponents != parse_unit(si_unit).half_exponents) {
    throw std::invalid_argument("\"" + std::string(whole) + "\" does not fit the unit [" +
                                std::string(si_unit.empty() ? "1" : si_unit) + "]");
  }
  return value * unit.factor;
}

double unit_factor(std::string_view name, std::string_view si_unit) {
  const bool negated = name.starts_with('-');
  return parse_quantity((negated ? "-1 " : "1 ") + std::string(name.substr(negated ? 1 : 0)),
                        si_unit);
}

}  // namespace rio::io

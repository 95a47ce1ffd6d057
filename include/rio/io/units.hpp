// SPDX-License-Identifier: BSD-3-Clause
// Quantities with units in text: "2 deg", "5 cm", "0.66 deg/sqrt(h)", to SI.
#pragma once

#include <string_view>

namespace rio::io {

/// The value of `text` in SI units. A plain number is taken as SI; a number with a unit is
/// converted. Units: m km cm mm um, s ms us ns min h, rad mrad deg mdeg rpm, Hz, g mg ug, dB, %,
/// combined by * / ^ sqrt().
/// @param si_unit unit expected, such as "m/s^2/sqrt(Hz)"; "" = dimensionless
/// @throws std::invalid_argument if `text` is not a number, its unit is unknown or of another
/// dimension
double parse_quantity(std::string_view text, std::string_view si_unit);

/// The factor of a unit to SI, as "g" or, of a sensor with the other sign, "-g". Throws as
/// parse_quantity().
double unit_factor(std::string_view name, std::string_view si_unit);

}  // namespace rio::io

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <numbers>

namespace rio::check {

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< [rad]

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

}  // namespace rio::check

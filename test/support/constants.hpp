// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

namespace rio::test {

inline constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]
inline constexpr double kGravity = 9.81;                     // [m/s^2]

}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rio/types.hpp"

namespace rio::test {

inline constexpr double kGravity = 9.81;  // [m/s^2]

}  // namespace rio::test

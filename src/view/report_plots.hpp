// SPDX-License-Identifier: BSD-3-Clause
// Which plots the page about one run has.
#pragma once

#include <cstddef>
#include <vector>

#include "view/page.hpp"

namespace rio::view {

inline constexpr const char* kAxes[] = {"x", "y", "z"};

/// Over columns that ReportBuilder fills. A sigma has the name of its column with an s before it. A
/// plot without its columns is left out.
std::vector<Plot> report_plots(std::size_t radars);

}  // namespace rio::view

// SPDX-License-Identifier: BSD-3-Clause
// The plots of the page about one run, over columns that ReportBuilder fills.
#pragma once

#include <cstddef>
#include <vector>

#include "view/page.hpp"

namespace rio::view {

/// Of the axes of a vector.
inline constexpr const char* kAxes[] = {"x", "y", "z"};

/// A sigma has the name of its column with an s before it. A plot without its columns is left out.
std::vector<Plot> report_plots(std::size_t radars);

}  // namespace rio::view

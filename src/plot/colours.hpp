// SPDX-License-Identifier: BSD-3-Clause
// The colours of curves: Okabe and Ito, "Color Universal Design", 2008, distinct for colour-blind
// readers.
#pragma once

#include <array>
#include <cstddef>

#include "plot/svg.hpp"

namespace rio::plot {

/// Without their black and yellow, which are too close to text and paper.
inline constexpr std::array<const char*, 6> kColours = {"#0072b2", "#d55e00", "#009e73",
                                                        "#cc79a7", "#e69f00", "#56b4e9"};

/// How curve `i` of a chart is drawn; dashed when the colours are used up.
inline Stroke curve_stroke(std::size_t i) {
  constexpr double kCurveWidth = 1.6;
  return {kColours[i % kColours.size()], kCurveWidth, i >= kColours.size()};
}

}  // namespace rio::plot

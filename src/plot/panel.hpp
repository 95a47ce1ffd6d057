// SPDX-License-Identifier: BSD-3-Clause
// The contents of one panel of a chart, and the ranges of its axes.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "plot/axes.hpp"
#include "plot/svg.hpp"

namespace rio::plot {

/// A line through points, in their order. A point that is not finite, or not positive on a
/// logarithmic axis, interrupts it. Curves with the same label share one entry of the legend; an
/// empty label has none.
struct Curve {
  std::string label;
  std::vector<Point> points;
  Stroke stroke;
};

/// The area between two lines over x, filled translucently; the three lists have one length. Where
/// a value is not finite the band is interrupted; on a logarithmic axis a low side of zero or less
/// reaches to the bottom.
struct Band {
  std::vector<double> x;
  std::vector<double> low;
  std::vector<double> high;
  std::string colour;
};

/// A horizontal line across the panel with a short label at its right end, outside the frame. Not
/// drawn if outside the axis.
struct Level {
  double value = 0.0;
  std::string label;
  Stroke stroke;
};

/// One pair of axes and its contents.
struct Panel {
  std::string title;
  std::string x_label;  ///< with unit; empty: also omits the numbers below
  std::string y_label;  ///< with unit
  std::vector<Curve> curves;
  std::vector<Band> bands;
  std::vector<Level> levels;
  bool log_y = false;
  bool from_zero = false;  ///< a linear axis that begins at 0 unless `y` is given
  /// Range of the y axis; by default that of the contents. Needs low < high, on a logarithmic axis
  /// 0 < low, else the default is used.
  std::optional<Range> y = std::nullopt;
};

/// A range of zero width is widened to one, an empty one becomes 0 to 1.
inline Range with_width(const Range& range, double share) {
  if (range.low > range.high) return {0.0, 1.0};
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  return range.padded(share, largest > 0.0 ? 1e-3 * largest : 1.0);
}

/// From the first to the last x of the contents.
inline Range x_range(const Panel& panel) {
  Range x;
  for (const Curve& curve : panel.curves) {
    for (const Point& point : curve.points) x.add(point.x);
  }
  for (const Band& band : panel.bands) {
    for (const double value : band.x) x.add(value);
  }
  return with_width(x, 0.0);
}

/// The y range of the contents: all finite values, on a logarithmic axis all positive ones.
inline Range y_values(const Panel& panel) {
  Range y;
  const auto add = [&](double value) {
    if (!panel.log_y || value > 0.0) y.add(value);
  };
  for (const Curve& curve : panel.curves) {
    for (const Point& point : curve.points) add(point.y);
  }
  for (const Band& band : panel.bands) {
    for (const double value : band.low) add(value);
    for (const double value : band.high) add(value);
  }
  for (const Level& level : panel.levels) add(level.value);
  return y;
}

/// Panel::y if it can be used, else the range of the contents with a margin.
inline Range y_range(const Panel& panel) {
  if (panel.y && panel.y->low < panel.y->high && (!panel.log_y || panel.y->low > 0.0)) {
    return *panel.y;
  }
  Range y = y_values(panel);
  if (panel.log_y) {
    if (y.low > y.high) return {0.1, 10.0};
    const double factor = std::pow(y.high / y.low, 0.05) * 1.05;  // 5 % of the axis and 5 % of y
    return {y.low / factor, y.high * factor};
  }
  if (panel.from_zero) y.add(0.0);
  y = with_width(y, 0.05);
  if (panel.from_zero) y.low = 0.0;
  return y;
}

}  // namespace rio::plot

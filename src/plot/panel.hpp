// SPDX-License-Identifier: BSD-3-Clause
// The contents of one panel of a chart, the ranges of its axes, the strokes of its curves, a
// legend.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plot/axes.hpp"
#include "plot/svg.hpp"

namespace rio::plot {

/// The colours of curves: Okabe and Ito, "Color Universal Design", 2008, distinct for colour-blind
/// readers; without their black and yellow, which are too close to text and paper.
inline constexpr std::array<const char*, 6> kColours = {"#0072b2", "#d55e00", "#009e73",
                                                        "#cc79a7", "#e69f00", "#56b4e9"};

/// How curve `i` of a chart is drawn; dashed when the colours are used up.
inline Stroke curve_stroke(std::size_t i) {
  constexpr double kCurveWidth = 1.6;
  return {kColours[i % kColours.size()], kCurveWidth, i >= kColours.size()};
}

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

/// A legend: samples with their names, in lines that wrap at the right margin.
class Legend {
 public:
  /// @param top middle of the first line
  Legend(Svg* svg, double left, double top, double right)
      : svg_(svg), left_(left), right_(right), x_(left), y_(top) {}

  /// @param draw_sample called with the left end of the 28 pixels for the sample
  template <class DrawSample>
  void entry(const std::string& name, DrawSample draw_sample) {
    const double width = kNameOffset + 2.0 + text_width(name, kSize);
    if (x_ > left_ && x_ + width > right_) {
      x_ = left_;
      y_ += 22.0;
    }
    draw_sample(Point{x_, y_});
    svg_->text({x_ + kNameOffset, y_ + 4.5}, name, {kSize});
    x_ += width + 18.0;
  }
  /// A line as sample; a thin one is drawn thicker so that its colour shows.
  void line(const std::string& name, const Stroke& stroke) {
    entry(name, [&](Point at) {
      svg_->line(at, {at.x + 28.0, at.y},
                 {stroke.colour, std::max(3.0, stroke.width), stroke.dashed});
    });
  }
  /// Middle of the last line.
  double bottom() const { return y_; }

 private:
  static constexpr double kSize = 13.0;
  static constexpr double kNameOffset = 36.0;

  Svg* svg_;
  double left_;
  double right_;
  double x_;
  double y_;
};

}  // namespace rio::plot

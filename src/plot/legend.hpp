// SPDX-License-Identifier: BSD-3-Clause
// A legend: samples with their names, in lines that wrap at the right margin.
#pragma once

#include <algorithm>
#include <string>

#include "plot/svg.hpp"

namespace rio::plot {

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

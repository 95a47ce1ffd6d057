// SPDX-License-Identifier: BSD-3-Clause
// A chart of panels with one legend, as one self-contained SVG file, for experiments.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "plot/axes.hpp"
#include "plot/panel.hpp"
#include "plot/svg.hpp"

namespace rio::plot {

/// Draws the panels of a chart; see draw_chart.
class ChartWriter {
 public:
  ChartWriter(const std::vector<Panel>& panels, int columns) : panels_(panels) {
    const auto count = std::max<std::size_t>(1, panels.size());
    columns_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::max(1, columns)), 1, count);
    cell_ = kWidth / static_cast<double>(columns_);
    height_ = std::clamp(0.6 * cell_, 180.0, 260.0);
    for (const Panel& panel : panels) {
      const auto marks = vertical_ticks(y_range(panel), panel.log_y, height_);
      left_ = std::max(left_, Axes::label_offset(marks) + 18.0);
      for (const Level& level : panel.levels) {
        right_ = std::max(right_, kLeader + text_width(level.label, kLevelSize) + 12.0);
      }
    }
  }

  std::string draw(const std::string& title) const {
    Svg measure(kWidth, 0.0);
    const double top = draw_head(&measure, title);
    Svg svg(kWidth, draw_panels(&measure, top));
    draw_head(&svg, title);
    draw_panels(&svg, top);
    return svg.str();
  }

 private:
  static constexpr double kWidth = 1000.0;
  static constexpr double kLevelSize = 11.0;
  static constexpr double kLeader = 9.0;  ///< from the frame to the label of a level

  /// Title and legend; returns their lower end.
  double draw_head(Svg* svg, const std::string& title) const {
    const double margin = 16.0;
    double end = 4.0;
    if (!title.empty()) {
      svg->text({margin, 29.0}, title,
                {fitted_size(title, 18.0, kWidth - 2.0 * margin), Anchor::kStart, true});
      end = 38.0;
    }
    Legend legend(svg, margin, end + 16.0, kWidth - margin);
    std::set<std::string> labels = {""};
    for (const Panel& panel : panels_) {
      for (const Curve& curve : panel.curves) {
        if (labels.insert(curve.label).second) legend.line(curve.label, curve.stroke);
      }
    }
    return labels.size() > 1 ? legend.bottom() + 10.0 : end;
  }

  /// Row by row; returns the lower end.
  double draw_panels(Svg* svg, double top) const {
    for (std::size_t first = 0; first < panels_.size(); first += columns_) {
      const std::size_t end = std::min(panels_.size(), first + columns_);
      top += 34.0;  // titles of the panels
      bool numbers_below = false;
      for (std::size_t i = first; i < end; ++i) {
        const double left = cell_ * static_cast<double>(i - first) + left_;
        draw_panel(svg, {left, top, cell_ - left_ - right_, height_}, panels_[i]);
        numbers_below = numbers_below || !panels_[i].x_label.empty();
      }
      top += height_ + (numbers_below ? 48.0 : 10.0);
    }
    return top;
  }

  static void draw_panel(Svg* svg, const Box& box, const Panel& panel) {
    const Range y = y_range(panel);
    const Axes axes(svg, box, x_range(panel), y, panel.log_y);
    axes.draw(panel.title, panel.x_label, panel.y_label);
    svg->begin_clip(box);
    for (const Band& band : panel.bands) {
      draw_band(svg, axes, band, panel.log_y ? y.low : -std::numeric_limits<double>::infinity());
    }
    for (const Curve& curve : panel.curves) axes.curve(curve.points, curve.stroke);
    for (const Level& level : panel.levels) {
      const double height = axes.pixel(0.0, level.value).y;
      if (std::isfinite(height)) {
        svg->line({box.left, height}, {box.right(), height}, level.stroke);
      }
    }
    svg->end_clip();
    draw_level_labels(svg, box, axes, panel.levels);
  }

  /// @param lowest lower limit of the drawn low side
  static void draw_band(Svg* svg, const Axes& axes, const Band& band, double lowest) {
    constexpr double kOpacity = 0.2;
    std::vector<Point> high;
    std::vector<Point> low;
    const auto finish = [&] {
      high.insert(high.end(), low.rbegin(), low.rend());
      svg->area(high, band.colour, kOpacity);
      high.clear();
      low.clear();
    };
    const std::size_t count = std::min({band.x.size(), band.low.size(), band.high.size()});
    for (std::size_t i = 0; i < count; ++i) {
      const Point above = axes.pixel(band.x[i], band.high[i]);
      const Point below = axes.pixel(band.x[i], std::max(band.low[i], lowest));
      if (!std::isfinite(above.x + above.y + below.y)) {
        finish();
        continue;
      }
      high.push_back(above);
      low.push_back(below);
    }
    finish();
  }

  /// At the right of the frame, from top to bottom, moved apart where they would overlap; a short
  /// line leads from each level to its label.
  static void draw_level_labels(Svg* svg, const Box& box, const Axes& axes,
                                std::vector<Level> levels) {
    const auto height = [&axes](const Level& level) { return axes.pixel(0.0, level.value).y; };
    const auto hidden = [&](const Level& level) {
      const double y = height(level);
      return level.label.empty() || !(y >= box.top && y <= box.bottom());
    };
    std::erase_if(levels, hidden);
    std::sort(levels.begin(), levels.end(),
              [](const Level& a, const Level& b) { return a.value > b.value; });
    std::vector<double> y;
    y.reserve(levels.size());
    for (const Level& level : levels) {
      y.push_back(y.empty() ? height(level) : std::max(height(level), y.back() + kLevelSize));
    }
    double limit = box.bottom();
    for (std::size_t i = levels.size(); i-- > 0; limit = y[i] - kLevelSize) {
      y[i] = std::min(y[i], limit);
      const Stroke leader{levels[i].stroke.colour, 0.8};
      const double x = box.right() + kLeader;
      svg->line({box.right(), height(levels[i])}, {x, y[i]}, leader);
      svg->text({x + 2.0, y[i] + 4.0}, levels[i].label,
                {kLevelSize, Anchor::kStart, false, false, levels[i].stroke.colour});
    }
  }

  const std::vector<Panel>& panels_;
  std::size_t columns_ = 1;
  double cell_ = 0.0;    ///< width of a panel with its margins
  double height_ = 0.0;  ///< of the frame of a panel
  double left_ = 0.0;    ///< margin of the frame in its cell
  double right_ = 20.0;  ///< same; half of the last number below fits in 20
};

/// One SVG file, 1000 pixels wide on white: the panels in rows of `columns`, below the title and a
/// legend with each label once. Axes of one column are aligned.
inline std::string draw_chart(const std::string& title, const std::vector<Panel>& panels,
                              int columns) {
  return ChartWriter(panels, columns).draw(title);
}

}  // namespace rio::plot

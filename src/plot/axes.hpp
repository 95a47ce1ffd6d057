// SPDX-License-Identifier: BSD-3-Clause
// Axes with a grid to draw curves on: linear, or with a logarithmic y axis. Pixels, y down.
// With (l, t, w, h) the box, [x0, x1] and [y0, y1] the ranges, s(y) = y or log10(y):
// (E1) px = l + w (x - x0) / (x1 - x0)
// (E2) py = t + h (s(y1) - s(y)) / (s(y1) - s(y0))
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plot/svg.hpp"

namespace rio::plot {

/// Smallest interval that contains the given finite values.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  double span() const { return high - low; }
  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Grown by a share of itself at both ends, at least to `smallest`; 0 to 1 if it was empty.
  Range padded(double share, double smallest) const {
    if (low > high) return {0.0, 1.0};
    const double margin = std::max(share * span(), 0.5 * (smallest - span()));
    return {low - margin, high + margin};
  }
};

/// A marked value of an axis with its label.
struct Tick {
  double value = 0.0;
  std::string label;
};

/// `value` as m.mmeE, digits down to the given decimal of the value itself.
inline std::string scientific(double value, int decimals) {
  if (value == 0.0) return "0";
  constexpr int kDigits = 15;  // of a double
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
  const int digits = std::clamp(exponent + decimals, 0, kDigits);
  const std::string mantissa = fixed(value / std::pow(10.0, exponent), digits);
  return exponent == 0 ? mantissa : mantissa + "e" + std::to_string(exponent);
}

/// @param exponent power of ten of its last digit
inline Tick tick_at(double value, int exponent, bool plain) {
  return {value, plain ? fixed(value, std::max(0, -exponent)) : scientific(value, -exponent)};
}

/// Round values inside a range: 1, 2 or 5 times a power of ten apart.
/// @param about desired number
inline std::vector<Tick> ticks(const Range& range, int about) {
  const double raw = range.span() / about;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / power;
  const double step = power * (ratio < 1.4 ? 1.0 : ratio < 3.2 ? 2.0 : ratio < 7.0 ? 5.0 : 10.0);
  const int exponent = static_cast<int>(std::floor(std::log10(step) + 1e-9));
  const bool plain = exponent >= -4 && std::max(std::abs(range.low), std::abs(range.high)) < 1e6;
  std::vector<Tick> result;
  for (double k = std::ceil(range.low / step - 1e-9); k * step <= range.high + 1e-9 * step; ++k) {
    result.push_back(tick_at(k * step, exponent, plain));
  }
  return result;
}

/// Values 1, 2 and 5 times powers of ten inside a positive range; powers of ten alone, or every
/// second, third... of them, if space is limited; round values if the range is narrow.
inline std::vector<Tick> log_ticks(const Range& range, int about) {
  constexpr double kNarrow = 0.7;  // decades; more always hold two values of 1-2-5
  const double decades = std::log10(range.high / range.low);
  if (decades < kNarrow) return ticks(range, about);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / about)));
  const bool between = 3.0 * decades <= about;
  const int first = static_cast<int>(std::floor(std::log10(range.low)));
  const int last = static_cast<int>(std::floor(std::log10(range.high)));
  const bool plain = first >= -4 && last < 6;
  std::vector<Tick> result;
  for (int exponent = first; exponent <= last; ++exponent) {
    if (exponent % every != 0) continue;
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10.0, exponent);
      if (value < range.low || value > range.high || (factor > 1.0 && !between)) continue;
      result.push_back(tick_at(value, exponent, plain));
    }
  }
  return result;
}

/// Ticks of a vertical axis of this height.
inline std::vector<Tick> vertical_ticks(const Range& y, bool log_y, double height) {
  const double spacing = log_y ? 24.0 : height < 300.0 ? 40.0 : 70.0;
  const int about = std::max(2, static_cast<int>(height / spacing));
  return log_y ? log_ticks(y, about) : ticks(y, about);
}

/// A frame with a grid: maps values to pixels.
class Axes {
 public:
  /// @param log_y logarithmic y axis; needs y.low > 0. Both ranges need low < high.
  Axes(Svg* svg, const Box& box, const Range& x, const Range& y, bool log_y = false)
      : svg_(svg), box_(box), x_(x), y_(y), log_y_(log_y) {}

  /// (E1) and (E2), at most 1e6 pixels from the origin. Not finite if a logarithmic axis cannot
  /// show the value.
  Point pixel(double x, double y) const {
    return {near(box_.left + (x - x_.low) / x_.span() * box_.width),
            near(box_.top + share(y) * box_.height)};
  }
  /// Grid, frame and labels; an empty `x_label` also omits the numbers below.
  void draw(const std::string& title, const std::string& x_label,
            const std::string& y_label) const {
    for (const Tick& tick : horizontal_ticks()) {
      const double x = pixel(tick.value, y_.high).x;
      svg_->line({x, box_.top}, {x, box_.bottom()}, grid(tick.value));
      if (x_label.empty()) continue;
      svg_->text({x, box_.bottom() + 17.0}, tick.label, {kTickSize, Anchor::kMiddle});
    }
    const std::vector<Tick> marks = vertical_ticks(y_, log_y_, box_.height);
    for (const Tick& tick : marks) {
      const double y = pixel(x_.low, tick.value).y;
      svg_->line({box_.left, y}, {box_.right(), y}, grid(tick.value));
      svg_->text({box_.left - kTickGap, y + 4.0}, tick.label, {kTickSize, Anchor::kEnd});
    }
    svg_->rectangle(box_, "none", {"#8a8a8a", 1.0});
    svg_->text({box_.left, box_.top - 9.0}, title,
               {fitted_size(title, 14.0, box_.width), Anchor::kStart, true});
    const Point centre{box_.left + 0.5 * box_.width, box_.top + 0.5 * box_.height};
    svg_->text({centre.x, box_.bottom() + 37.0}, x_label,
               {fitted_size(x_label, 13.0, box_.width), Anchor::kMiddle});
    svg_->text({box_.left - label_offset(marks), centre.y}, y_label,
               {fitted_size(y_label, 13.0, box_.height + 20.0), Anchor::kMiddle, false, true});
  }
  void curve(std::vector<Point> values, const Stroke& stroke) const {
    for (Point& point : values) point = pixel(point.x, point.y);
    svg_->curve(values, stroke);
  }

  /// From the frame to the base line of the label of the y axis.
  static double label_offset(const std::vector<Tick>& marks) {
    double widest = 0.0;
    for (const Tick& tick : marks) widest = std::max(widest, text_width(tick.label, kTickSize));
    return std::max(54.0, kTickGap + widest + 3.0);
  }

 private:
  static constexpr double kTickSize = 12.0;
  static constexpr double kTickGap = 7.0;

  static Stroke grid(double value) { return {value == 0.0 ? "#b0b0b0" : "#e4e4e4", 1.0}; }

  /// Far outside, only the direction matters: renderers keep some 23 bits before the point.
  static double near(double pixel) {
    constexpr double kFar = 1e6;
    return std::isfinite(pixel) ? std::clamp(pixel, -kFar, kFar) : pixel;
  }
  /// The fraction of (E2): 0 at the top of the box, 1 at its bottom; not finite for y <= 0
  /// on a logarithmic axis.
  double share(double y) const {
    if (!log_y_) return (y_.high - y) / y_.span();
    return std::log(y_.high / y) / std::log(y_.high / y_.low);
  }
  /// As many as fit without touching each other.
  std::vector<Tick> horizontal_ticks() const {
    const auto fits = [this](const std::vector<Tick>& marks) {
      double sum = 0.0;
      for (const Tick& tick : marks) sum += text_width(tick.label, kTickSize) + 8.0;
      return sum <= box_.width;
    };
    int about = std::max(1, static_cast<int>(box_.width / 70.0));
    while (about > 1 && !fits(ticks(x_, about))) --about;
    return ticks(x_, about);
  }

  Svg* svg_;
  Box box_;
  Range x_;
  Range y_;
  bool log_y_;
};

}  // namespace rio::plot

// SPDX-License-Identifier: BSD-3-Clause
// A drawing as SVG text, and axes with a grid to draw curves on. Pixels, y down.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace rio::tools {

/// A point of a curve; one that is not finite interrupts the curve.
struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// Smallest interval that holds the finite values it was given.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  double span() const { return high - low; }
  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Grown by a share of itself at both ends, to `smallest` at least; 0 to 1 if it was empty.
  Range padded(double share, double smallest) const {
    if (low > high) return {0.0, 1.0};
    const double margin = std::max(share * span(), 0.5 * (smallest - span()));
    return {low - margin, high + margin};
  }
};

/// Text with the characters that XML reserves replaced.
inline std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// `value` with the given number of decimals, without the sign of a negative zero.
inline std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  const std::string result = text;
  return result.find_first_of("123456789") == std::string::npos && result[0] == '-'
             ? result.substr(1)
             : result;
}

struct Stroke {
  std::string colour = "#222222";
  double width = 1.0;
  bool dashed = false;
};

enum class Anchor { kStart, kMiddle, kEnd };

struct TextStyle {
  double size = 12.0;
  Anchor anchor = Anchor::kStart;
  bool bold = false;
  bool upright = false;  ///< turned to read from bottom to top
  std::string colour = "#222222";
};

/// Collects shapes; str() is the finished file.
class Svg {
 public:
  Svg(double width, double height) : width_(width), height_(height) {
    rectangle(0.0, 0.0, width, height, "#ffffff", {"none", 0.0});
  }

  void rectangle(double x, double y, double w, double h, const std::string& fill,
                 const Stroke& stroke) {
    body_ += "<rect" + attribute("x", x) + attribute("y", y) + attribute("width", w) +
             attribute("height", h) + painted(fill, stroke) + "/>\n";
  }
  void circle(Point centre, double radius, const std::string& fill, const Stroke& stroke) {
    body_ += "<circle" + attribute("cx", centre.x) + attribute("cy", centre.y) +
             attribute("r", radius) + painted(fill, stroke) + "/>\n";
  }
  void line(Point a, Point b, const Stroke& stroke) {
    body_ += "<line" + attribute("x1", a.x) + attribute("y1", a.y) + attribute("x2", b.x) +
             attribute("y2", b.y) + painted("none", stroke) + "/>\n";
  }
  void text(Point at, const std::string& content, const TextStyle& style = {}) {
    static const char* const kAnchors[] = {"start", "middle", "end"};
    body_ += "<text" + attribute("x", at.x) + attribute("y", at.y) +
             attribute("font-size", style.size) + " fill=\"" + style.colour + "\" text-anchor=\"" +
             kAnchors[static_cast<int>(style.anchor)] + "\"";
    if (style.bold) body_ += " font-weight=\"bold\"";
    if (style.upright) {
      body_ += " transform=\"rotate(-90 " + fixed(at.x, 1) + " " + fixed(at.y, 1) + ")\"";
    }
    body_ += ">" + escaped(content) + "</text>\n";
  }
  /// A curve. Points less than a pixel from the last one drawn are left out.
  void curve(const std::vector<Point>& points, const Stroke& stroke) {
    std::string path;
    Point last;
    Point skipped;
    bool drawing = false;
    bool pending = false;
    const auto finish = [&] {
      if (pending) path += " L" + coordinates(skipped);
      drawing = pending = false;
    };
    for (const Point& point : points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
        finish();
      } else if (drawing && std::hypot(point.x - last.x, point.y - last.y) < 1.0) {
        skipped = point;
        pending = true;
      } else {
        path += (drawing ? " L" : " M") + coordinates(point);
        last = point;
        drawing = true;
        pending = false;
      }
    }
    finish();
    if (path.empty()) return;
    body_ += "<path d=\"" + path.substr(1) + "\"" + painted("none", stroke) +
             " stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n";
  }

  std::string str() const {
    const std::string w = fixed(width_, 0);
    const std::string h = fixed(height_, 0);
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
           "\" viewBox=\"0 0 " + w + " " + h +
           "\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n" + body_ + "</svg>\n";
  }

 private:
  static std::string attribute(const char* name, double value) {
    return std::string(" ") + name + "=\"" + fixed(value, 1) + "\"";
  }
  static std::string coordinates(Point p) { return fixed(p.x, 1) + " " + fixed(p.y, 1); }
  static std::string painted(const std::string& fill, const Stroke& stroke) {
    std::string text = " fill=\"" + fill + "\"";
    if (stroke.width > 0.0) {
      text += " stroke=\"" + stroke.colour + "\"" + attribute("stroke-width", stroke.width);
      if (stroke.dashed) text += " stroke-dasharray=\"6 4\"";
    }
    return text;
  }

  double width_;
  double height_;
  std::string body_;
};

/// Round tick values of a range: 1, 2 or 5 times a power of ten apart.
struct Ticks {
  std::vector<double> values;
  int decimals = 0;
};

inline Ticks ticks(const Range& range, int about) {
  const double raw = range.span() / about;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / power;
  const double step = power * (ratio < 1.4 ? 1.0 : ratio < 3.2 ? 2.0 : ratio < 7.0 ? 5.0 : 10.0);
  Ticks result;
  result.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(range.low / step - 1e-9); k * step <= range.high + 1e-9 * step; ++k) {
    result.values.push_back(k * step);
  }
  return result;
}

/// A frame with a grid: maps values to pixels.
class Axes {
 public:
  Axes(Svg* svg, double left, double top, double width, double height, const Range& x,
       const Range& y)
      : svg_(svg), left_(left), top_(top), width_(width), height_(height), x_(x), y_(y) {}

  Point pixel(double x, double y) const {
    return {left_ + (x - x_.low) / x_.span() * width_, top_ + (y_.high - y) / y_.span() * height_};
  }
  /// Grid, frame and labels; an empty `x_label` leaves out the numbers below, too.
  void draw(const std::string& title, const std::string& x_label, const std::string& y_label) {
    const Ticks x_ticks = ticks(x_, static_cast<int>(width_ / 70.0));
    const double spacing = height_ < 300.0 ? 40.0 : 70.0;
    const Ticks y_ticks = ticks(y_, std::max(2, static_cast<int>(height_ / spacing)));
    const double bottom = top_ + height_;
    for (const double value : x_ticks.values) {
      const double x = pixel(value, 0.0).x;
      svg_->line({x, top_}, {x, bottom}, grid(value));
      if (x_label.empty()) continue;
      svg_->text({x, bottom + 17.0}, fixed(value, x_ticks.decimals), {12.0, Anchor::kMiddle});
    }
    for (const double value : y_ticks.values) {
      const double y = pixel(0.0, value).y;
      svg_->line({left_, y}, {left_ + width_, y}, grid(value));
      svg_->text({left_ - 7.0, y + 4.0}, fixed(value, y_ticks.decimals), {12.0, Anchor::kEnd});
    }
    svg_->rectangle(left_, top_, width_, height_, "none", {"#8a8a8a", 1.0});
    svg_->text({left_, top_ - 9.0}, title, {14.0, Anchor::kStart, true});
    svg_->text({left_ + 0.5 * width_, bottom + 37.0}, x_label, {13.0, Anchor::kMiddle});
    svg_->text({left_ - 54.0, top_ + 0.5 * height_}, y_label, {13.0, Anchor::kMiddle, false, true});
  }
  void curve(std::vector<Point> values, const Stroke& stroke) {
    for (Point& point : values) point = pixel(point.x, point.y);
    svg_->curve(values, stroke);
  }

 private:
  static Stroke grid(double value) { return {value == 0.0 ? "#b0b0b0" : "#e4e4e4", 1.0}; }

  Svg* svg_;
  double left_;
  double top_;
  double width_;
  double height_;
  Range x_;
  Range y_;
};

}  // namespace rio::tools

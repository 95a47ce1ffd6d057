// SPDX-License-Identifier: BSD-3-Clause
// A drawing as SVG text: lines, areas, text, curves, and a clip window. Pixels, y down.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rio::plot {

/// A point of a curve; one that is not finite interrupts the curve.
struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// A rectangle; `top` is its smaller y.
struct Box {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

/// Text with the characters that XML reserves replaced, and U+FFFD for bytes that are not UTF-8.
inline std::string escaped(const std::string& text) {
  using Json = nlohmann::json;
  const std::string quoted = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  const auto valid = Json::parse(quoted).get<std::string>();
  std::string result;
  for (const char c : valid) {
    result += c == '&'   ? "&amp;"
              : c == '<' ? "&lt;"
              : c == '>' ? "&gt;"
              : c == '"' ? "&quot;"
                         : std::string(1, c);
  }
  return result;
}

/// `value` with the given number of decimals, without the sign of a negative zero.
inline std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  const bool negative_zero = text[0] == '-' && std::strpbrk(text, "123456789") == nullptr;
  return text + (negative_zero ? 1 : 0);
}

/// The same with its sign, of zero a plus.
inline std::string signed_fixed(double value, int decimals) {
  const std::string text = fixed(value, decimals);
  return text[0] == '-' ? text : "+" + text;
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
  bool upright = false;  ///< rotated to read from bottom to top
  std::string colour = "#222222";
};

/// Approximate width of a text; the exact width depends on the reader's font.
inline double text_width(const std::string& text, double size) {
  constexpr double kCharacter = 0.6;  // mean width of a letter over the size of a broad font
  const auto characters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // not the rest of a UTF-8 sequence
  });
  return kCharacter * size * static_cast<double>(characters);
}

/// `size`, or less if the text would be wider than `width`.
inline double fitted_size(const std::string& text, double size, double width) {
  const double wanted = text_width(text, size);
  return wanted > width ? size * width / wanted : size;
}

/// Collects shapes; str() is the finished file.
class Svg {
 public:
  Svg(double width, double height) : width_(width), height_(height) {
    rectangle({0.0, 0.0, width, height}, "#ffffff", {"none", 0.0});
  }

  void rectangle(const Box& box, const std::string& fill, const Stroke& stroke) {
    body_ += rect(box) + painted(fill, stroke) + "/>\n";
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
      body_ += std::string(" transform=\"rotate(-90 ").append(fixed(at.x, 1)) + " " +
               fixed(at.y, 1) + ")\"";
    }
    body_.append(">").append(escaped(content)).append("</text>\n");
  }
  /// A curve. Points less than a pixel from the last one drawn are left out.
  void curve(const std::vector<Point>& points, const Stroke& stroke) {
    const std::string path = outline(points);
    if (path.empty()) return;
    body_ += "<path d=\"" + path + "\"" + painted("none", stroke) +
             " stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n";
  }
  /// A polygon without an edge; all points finite.
  /// @param opacity 0 invisible, 1 hides what is below
  void area(const std::vector<Point>& points, const std::string& fill, double opacity) {
    const std::string path = outline(points);
    if (path.empty()) return;
    body_ += "<path d=\"" + path + " Z\"" + painted(fill, {"none", 0.0}) + " fill-opacity=\"" +
             fixed(opacity, 2) + "\"/>\n";
  }
  /// Clips everything drawn from here to end_clip() to the box. Not nested.
  void begin_clip(const Box& box) {
    const std::string id = "clip" + std::to_string(++clips_);
    body_ += "<clipPath id=\"" + id + "\">" + rect(box) + "/></clipPath>\n<g clip-path=\"url(#" +
             id + ")\">\n";
  }
  void end_clip() { body_ += "</g>\n"; }

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
  static std::string rect(const Box& box) {
    return "<rect" + attribute("x", box.left) + attribute("y", box.top) +
           attribute("width", box.width) + attribute("height", box.height);
  }
  /// The "d" of a path through the points, without those less than a pixel from the last one.
  static std::string outline(const std::vector<Point>& points) {
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
    return path.empty() ? path : path.substr(1);
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
  int clips_ = 0;
  std::string body_;
};

}  // namespace rio::plot

// SPDX-License-Identifier: BSD-3-Clause
// A chart is well-formed SVG, and values lie where its own tick labels say.
#include "plot/chart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/matches.hpp"

namespace rio::plot {
namespace {

using test::matches;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Coordinates are written with one decimal; two of them make a difference.
constexpr double kPixel = 0.1 + 1e-9;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t result = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++result;
  }
  return result;
}

/// Every element that is opened is closed, in order, and no reserved character stands in a text;
/// empty, or what is wrong.
std::string malformed(const std::string& svg) {
  const std::vector<std::string> tags = matches(svg, "<([^<>]*)>");
  if (count(svg, "<") != tags.size() || count(svg, ">") != tags.size()) return "a stray < or >";
  if (count(svg, "&") != matches(svg, "(&(amp|lt|gt|quot);)").size()) return "a bare &";
  std::vector<std::string> open;
  for (const std::string& tag : tags) {
    if (count(tag, "\"") % 2 != 0) return "<" + tag + ">";
    if (tag[0] == '/') {
      if (open.empty() || "/" + open.back() != tag) return "unexpected <" + tag + ">";
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

/// The unfilled paths of a colour, each as its pieces ("M" begins one) of points.
std::vector<std::vector<Point>> pieces(const std::string& svg, const std::string& colour) {
  std::vector<std::vector<Point>> result;
  for (const std::string& d :
       matches(svg, "<path d=\"([^\"]*)\" fill=\"none\" stroke=\"" + colour + "\"")) {
    std::istringstream stream(d);
    for (char command = 0; stream >> command;) {
      if (command == 'M') result.emplace_back();
      Point& point = result.back().emplace_back();
      stream >> point.x >> point.y;
    }
  }
  return result;
}

/// The number that the pattern captures, which must be there once.
double captured(const std::string& svg, const std::string& pattern) {
  const auto found = matches(svg, pattern);
  EXPECT_EQ(found.size(), 1U) << pattern;
  return found.empty() ? kNan : std::stod(found[0]);
}

/// The y pixel of the tick with this label, from the place of its text.
double tick_y(const std::string& svg, const std::string& label) {
  constexpr double kBaseLine = 4.0;  // the middle of a digit is above the line it stands on
  const std::string text = "[^>]*text-anchor=\"end\">" + label + "</text>";
  return captured(svg, "<text[^>]* y=\"([^\"]*)\"" + text) - kBaseLine;
}

/// The x pixel of the tick with this label.
double tick_x(const std::string& svg, const std::string& label) {
  const std::string text = "[^>]*text-anchor=\"middle\">" + label + "</text>";
  return captured(svg, "<text x=\"([^\"]*)\"[^>]*font-size=\"12.0\"" + text);
}

/// The rectangle of the first clip path.
Box clip_box(const std::string& svg) {
  const auto value = [&svg](const std::string& name) {
    return captured(svg, "<clipPath id=\"clip1\"><rect[^>]* " + name + "=\"([^\"]*)\"");
  };
  return {value("x"), value("y"), value("width"), value("height")};
}

Panel panel_of(std::vector<Point> points) {
  Panel panel;
  panel.title = "title";
  panel.x_label = "time [s]";
  panel.y_label = "y";
  panel.curves.push_back({"curve", std::move(points), curve_stroke(0)});
  return panel;
}

std::string draw(const Panel& panel) {
  return draw_chart("", {panel}, 1);
}

/// The points of the only curve, in pixels.
std::vector<Point> curve_in(const std::string& svg) {
  const auto drawn = pieces(svg, kColours[0]);
  EXPECT_EQ(drawn.size(), 1U) << "the curve is interrupted";
  return drawn.empty() ? std::vector<Point>() : drawn[0];
}

TEST(Chart, IsWellFormedAndWhiteWithALegendOfEachLabel) {
  Panel panel = panel_of({{0, 1}, {1, 2}, {2, 3}});
  panel.curves.push_back({"other", {{0, 2}, {1, 1}}, curve_stroke(1)});
  panel.curves.push_back({"", {{0, 2}, {1, 1}}, curve_stroke(2)});
  panel.bands.push_back({{0, 1, 2}, {0.5, 1.5, 2.5}, {1.5, 2.5, 3.5}, "#123456"});
  panel.levels.push_back({2.0, "two", {"#654321", 1.0, true}});
  const std::string svg = draw_chart("all of it", {panel, panel, panel}, 2);
  EXPECT_EQ(malformed(svg), "");
  EXPECT_EQ(svg.rfind("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1000\"", 0), 0U);
  EXPECT_NE(svg.find("width=\"1000.0\" height=\""), std::string::npos);
  EXPECT_NE(svg.find("fill=\"#ffffff\""), std::string::npos);
  EXPECT_EQ(count(svg, "<clipPath"), 3U);
  EXPECT_EQ(count(svg, ">curve</text>"), 1U);
  EXPECT_EQ(count(svg, ">other</text>"), 1U);
  EXPECT_EQ(count(svg, "></text>"), 0U);
  EXPECT_EQ(count(svg, "fill=\"#123456\" fill-opacity=\"0.20\""), 3U);
}

TEST(Chart, EscapesEveryText) {
  const std::string evil = "a<b & \"c\">";
  Panel panel = panel_of({{0, 1}, {1, 2}});
  panel.title = panel.x_label = panel.y_label = panel.curves[0].label = evil;
  panel.levels.push_back({1.5, evil, {}});
  const std::string svg = draw_chart(evil, {panel}, 1);
  EXPECT_EQ(malformed(svg), "");
  EXPECT_EQ(count(svg, "a&lt;b &amp; &quot;c&quot;&gt;"), 6U);
}

TEST(Chart, LinearAxisPlacesValuesAtTheirTicks) {
  const std::string svg = draw(panel_of({{0, 0}, {40, 20}, {100, -10}}));
  const auto curve = curve_in(svg);
  ASSERT_EQ(curve.size(), 3U);
  std::size_t i = 0;
  for (const char* label : {"0", "20", "-10"}) {
    EXPECT_NEAR(curve[i++].y, tick_y(svg, label), kPixel) << label;
  }
  EXPECT_LT(curve[1].y, curve[0].y) << "larger values are farther up";
  EXPECT_NEAR(curve[1].x, tick_x(svg, "40"), kPixel);
  EXPECT_NEAR(curve[2].x, tick_x(svg, "100"), kPixel);
}

TEST(Chart, LogAxisPlacesValuesAtTheirTicks) {
  Panel panel = panel_of({{0, 1}, {1, 5}, {2, 10}, {3, 100}, {4, std::sqrt(10.0)}});
  panel.log_y = true;
  const std::string svg = draw(panel);
  const auto curve = curve_in(svg);
  ASSERT_EQ(curve.size(), 5U);
  std::size_t i = 0;
  for (const char* label : {"1", "5", "10", "100"}) {
    EXPECT_NEAR(curve[i++].y, tick_y(svg, label), kPixel) << label;
  }
  const double decade = tick_y(svg, "1") - tick_y(svg, "10");
  EXPECT_NEAR(tick_y(svg, "10") - tick_y(svg, "100"), decade, 2.0 * kPixel);
  EXPECT_NEAR(tick_y(svg, "1") - tick_y(svg, "2"), std::log10(2.0) * decade, 2.0 * kPixel);
  EXPECT_NEAR(curve[4].y, tick_y(svg, "1") - 0.5 * decade, 2.0 * kPixel);
}

std::string labels(const std::vector<Tick>& ticks) {
  std::string result;
  for (const Tick& tick : ticks) result += tick.label + " ";
  return result;
}

TEST(Chart, TicksFitTheRoomAndStayShort) {
  EXPECT_EQ(labels(log_ticks({0.05, 30.0}, 10)), "0.05 0.1 0.2 0.5 1 2 5 10 20 ");
  EXPECT_EQ(labels(log_ticks({0.05, 30.0}, 5)), "0.1 1 10 ");
  EXPECT_EQ(labels(log_ticks({1e-7, 1e5}, 6)), "1e-6 1e-4 1e-2 1 1e2 1e4 ");
  EXPECT_EQ(labels(log_ticks({2.1, 4.9}, 6)), "2.5 3.0 3.5 4.0 4.5 ") << "too narrow for 1-2-5";
  EXPECT_EQ(labels(ticks({-0.3, 1.1}, 5)), "-0.2 0.0 0.2 0.4 0.6 0.8 1.0 ");
  EXPECT_EQ(labels(ticks({-2.2e-6, 2.2e-6}, 4)), "-2e-6 -1e-6 0 1e-6 2e-6 ");
  EXPECT_EQ(labels(ticks({0.0, 2.1e7}, 4)), "0 5e6 1.0e7 1.5e7 2.0e7 ");
}

TEST(Chart, WhatCannotBeDrawnInterruptsACurve) {
  const auto sizes = [](bool log_y, const std::vector<Point>& points) {  // of the pieces
    Panel panel = panel_of(points);
    panel.log_y = log_y;
    std::string all;
    for (const auto& piece : pieces(draw(panel), kColours[0])) {
      all += std::to_string(piece.size()) + " ";
    }
    return all;
  };
  EXPECT_EQ(sizes(true, {{0, 1}, {1, 10}, {2, 0}, {3, 10}, {4, 1}, {5, -3}, {6, 1}, {7, 10}}),
            "2 2 2 ");
  EXPECT_EQ(sizes(false, {{0, 1}, {1, 2}, {2, kNan}, {3, 1}, {4, 2}, {5, kInfinity}, {6, 1}}),
            "2 2 1 ");
}

TEST(Chart, NonFiniteValuesInterruptABand) {
  Panel panel;
  panel.bands.push_back({{0, 1, 2, 3, 4}, {0, 0, kNan, 0, 0}, {1, 1, 1, 1, 1}, "#123456"});
  const std::string svg = draw(panel);
  EXPECT_EQ(count(svg, "fill=\"#123456\""), 2U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Chart, BandOnALogAxisReachesTheBottomFromZero) {
  Panel panel;
  panel.log_y = true;
  panel.bands.push_back({{0, 1}, {-1, 1}, {10, 10}, "#123456"});
  const std::string svg = draw(panel);
  const Box box = clip_box(svg);
  // along the high side, back along the low side: the last point is the one at zero
  const std::string last = " L" + fixed(box.left, 1) + " " + fixed(box.bottom(), 1) + " Z";
  EXPECT_EQ(count(svg, last + "\" fill=\"#123456\""), 1U) << svg;
}

TEST(Chart, LevelsLieAtTheirValue) {
  Panel panel = panel_of({{0, 0}, {1, 10}});
  panel.levels.push_back({4.0, "four", {"#654321", 1.0}});
  const std::string svg = draw(panel);
  const std::string left = fixed(clip_box(svg).left, 1);
  EXPECT_NEAR(captured(svg, "<line x1=\"" + left + "\" y1=\"([^\"]*)\"[^>]*\"#654321\""),
              tick_y(svg, "4"), kPixel);
  EXPECT_EQ(count(svg, ">four</text>"), 1U);
}

TEST(Chart, LabelsOfLevelsDoNotOverlap) {
  for (const double first : {0.0, 990.0}) {  // at the bottom there is no room below, here there is
    Panel panel = panel_of({{0, 0}, {1, 1000}});
    for (const double value : {0.5, 3.0, 1.0, 2.0}) {
      panel.levels.push_back({first + value, "level", {}});
    }
    const std::string svg = draw(panel);
    std::vector<double> heights;
    for (const std::string& y : matches(svg, "<text[^>]* y=\"([^\"]*)\"[^>]*>level</text>")) {
      heights.push_back(std::stod(y));
    }
    ASSERT_EQ(heights.size(), 4U);
    std::sort(heights.begin(), heights.end());
    EXPECT_GT(heights.front(), clip_box(svg).top) << "pushed out of the frame";
    EXPECT_LT(heights.back(), clip_box(svg).bottom() + 5.0) << "pushed out of the frame";
    for (std::size_t i = 1; i < heights.size(); ++i) {
      EXPECT_GE(heights[i] - heights[i - 1], 11.0 - kPixel) << first;  // size of the font
    }
  }
}

TEST(Chart, ValuesBeyondTheRangeAreCutOff) {
  Panel panel = panel_of({{0, 0}, {1, 100}, {2, 1e30}, {3, -50}});
  panel.y = Range{0.0, 10.0};
  panel.levels.push_back({20.0, "unseen", {}});
  const std::string svg = draw(panel);
  const Box box = clip_box(svg);
  EXPECT_NEAR(box.top, tick_y(svg, "10"), kPixel);
  EXPECT_NEAR(box.bottom(), tick_y(svg, "0"), kPixel);
  const auto curve = curve_in(svg);
  ASSERT_EQ(curve.size(), 4U);
  EXPECT_LT(curve[1].y, box.top);
  EXPECT_GT(curve[3].y, box.bottom());
  EXPECT_EQ(matches(svg, "<g clip-path=\"url\\(#clip1\\)\">\\s*(<path [^>]*>)").size(), 1U) << svg;
  EXPECT_EQ(svg.find("unseen"), std::string::npos);
}

TEST(Chart, GivenRangeThatCannotBeDrawnIsReplaced) {
  Panel panel = panel_of({{0, 1}, {1, 9}});
  panel.log_y = true;
  panel.y = Range{0.0, 10.0};
  EXPECT_GT(y_range(panel).low, 0.0);
  EXPECT_LT(y_range(panel).low, 1.0);
  panel.log_y = false;
  panel.y = Range{3.0, 3.0};
  EXPECT_LT(y_range(panel).low, 1.0);
  EXPECT_GT(y_range(panel).high, 9.0);
}

TEST(Chart, FromZeroBeginsAtZero) {
  Panel panel = panel_of({{0, 5}, {1, 6}});
  EXPECT_GT(y_range(panel).low, 4.0);
  panel.from_zero = true;
  EXPECT_EQ(y_range(panel).low, 0.0);
  EXPECT_GT(y_range(panel).high, 6.0);
}

TEST(Chart, NothingToDrawIsDrawn) {
  for (const std::vector<Point>& points : std::vector<std::vector<Point>>{
           {}, {{kNan, kNan}, {0, kNan}}, {{2, 3}}, {{0, -1}, {1, -2}}, {{0, 0}, {1, 0}}}) {
    for (const bool log_y : {false, true}) {
      Panel panel = panel_of(points);
      panel.log_y = log_y;
      panel.from_zero = !log_y;
      const std::string svg = draw(panel);
      EXPECT_EQ(malformed(svg), "");
      EXPECT_EQ(count(svg, "nan") + count(svg, "inf"), 0U) << svg;
    }
  }
  EXPECT_EQ(malformed(draw_chart("", {}, 3)), "");
  EXPECT_EQ(malformed(draw_chart("", {Panel()}, 0)), "");
}

}  // namespace
}  // namespace rio::plot

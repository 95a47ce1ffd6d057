// SPDX-License-Identifier: BSD-3-Clause
// A chart is well-formed SVG, and values lie where its own tick labels say.
#include "plot/chart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "plot/colours.hpp"
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
  std::vector<std::string> open;
  std::size_t at = 0;
  while (at < svg.size()) {
    const std::size_t begin = svg.find('<', at);
    const std::string text = svg.substr(at, begin - at);
    if (text.find('>') != std::string::npos) return "stray > in \"" + text + "\"";
    if (count(text, "&") != matches(text, "(&(amp|lt|gt|quot);)").size())
      return "bare & in " + text;
    if (begin == std::string::npos) break;
    const std::size_t end = svg.find('>', begin);
    if (end == std::string::npos) return "a tag does not end";
    const std::string tag = svg.substr(begin + 1, end - begin - 1);
    if (count(tag, "\"") % 2 != 0 || tag.find('<') != std::string::npos) return "tag " + tag;
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag[0] == '/') {
      if (open.empty() || "/" + open.back() != tag) return "unexpected <" + tag + ">";
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
    at = end + 1;
  }
  return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

/// The unfilled paths of a colour, each as its pieces ("M" begins one) of points.
std::vector<std::vector<Point>> pieces(const std::string& svg, const std::string& colour) {
  std::vector<std::vector<Point>> result;
  for (const std::string& d :
       matches(svg, "<path d=\"([^\"]*)\" fill=\"none\" stroke=\"" + colour + "\"")) {
    std::istringstream stream(d);
    std::string word;
    while (stream >> word) {
      if (word[0] == 'M') result.emplace_back();
      Point point;
      point.x = std::stod(word.substr(1));
      stream >> point.y;
      result.back().push_back(point);
    }
  }
  return result;
}

/// The y pixel of the tick with this label, from the place of its text.
double tick_y(const std::string& svg, const std::string& label) {
  const auto found =
      matches(svg, "<text[^>]* y=\"([^\"]*)\"[^>]*text-anchor=\"end\">" + label + "</text>");
  EXPECT_EQ(found.size(), 1U) << label;
  constexpr double kBaseLine = 4.0;  // the middle of a digit is above the line it stands on
  return found.empty() ? kNan : std::stod(found[0]) - kBaseLine;
}

/// The x pixel of the tick with this label.
double tick_x(const std::string& svg, const std::string& label) {
  const auto found =
      matches(svg, "<text x=\"([^\"]*)\"[^>]*font-size=\"12.0\"[^>]*text-anchor=\"middle\">" +
                       label + "</text>");
  EXPECT_EQ(found.size(), 1U) << label;
  return found.empty() ? kNan : std::stod(found[0]);
}

/// The rectangle of the first clip path.
Box clip_box(const std::string& svg) {
  const auto value = [&svg](const std::string& name) {
    const auto found = matches(svg, "<clipPath id=\"clip1\"><rect[^>]* " + name + "=\"([^\"]*)\"");
    return found.empty() ? kNan : std::stod(found[0]);
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

TEST(Chart, IsWellFormedAndWhite) {
  Panel panel = panel_of({{0, 1}, {1, 2}, {2, 3}});
  panel.bands.push_back({{0, 1, 2}, {0.5, 1.5, 2.5}, {1.5, 2.5, 3.5}, "#123456"});
  panel.levels.push_back({2.0, "two", {"#654321", 1.0, true}});
  const std::string svg = draw_chart("all of it", {panel, panel, panel}, 2);
  EXPECT_EQ(malformed(svg), "");
  EXPECT_EQ(svg.rfind("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1000\"", 0), 0U);
  EXPECT_NE(svg.find("width=\"1000.0\" height=\""), std::string::npos);
  EXPECT_NE(svg.find("fill=\"#ffffff\""), std::string::npos);
  EXPECT_EQ(count(svg, "<clipPath"), 3U);
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

TEST(Chart, LegendNamesEachLabelOnce) {
  Panel panel = panel_of({{0, 1}, {1, 2}});
  panel.curves.push_back({"other", {{0, 2}, {1, 1}}, curve_stroke(1)});
  panel.curves.push_back({"", {{0, 2}, {1, 1}}, curve_stroke(2)});
  const std::string svg = draw_chart("", {panel, panel}, 2);
  EXPECT_EQ(count(svg, ">curve</text>"), 1U);
  EXPECT_EQ(count(svg, ">other</text>"), 1U);
}

TEST(Chart, LinearAxisPlacesValuesAtTheirTicks) {
  const std::string svg = draw_chart("", {panel_of({{0, 0}, {40, 20}, {100, -10}})}, 1);
  const auto drawn = pieces(svg, kColours[0]);
  ASSERT_EQ(drawn.size(), 1U);
  ASSERT_EQ(drawn[0].size(), 3U);
  EXPECT_NEAR(drawn[0][0].y, tick_y(svg, "0"), kPixel);
  EXPECT_NEAR(drawn[0][1].y, tick_y(svg, "20"), kPixel);
  EXPECT_NEAR(drawn[0][2].y, tick_y(svg, "-10"), kPixel);
  EXPECT_LT(drawn[0][1].y, drawn[0][0].y) << "larger values are farther up";
  EXPECT_NEAR(drawn[0][1].x, tick_x(svg, "40"), kPixel);
  EXPECT_NEAR(drawn[0][2].x, tick_x(svg, "100"), kPixel);
}

TEST(Chart, LogAxisPlacesValuesAtTheirTicks) {
  Panel panel = panel_of({{0, 1}, {1, 5}, {2, 10}, {3, 100}, {4, std::sqrt(10.0)}});
  panel.log_y = true;
  const std::string svg = draw_chart("", {panel}, 1);
  const auto drawn = pieces(svg, kColours[0]);
  ASSERT_EQ(drawn.size(), 1U);
  ASSERT_EQ(drawn[0].size(), 5U);
  const std::vector<std::string> labels = {"1", "5", "10", "100"};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_NEAR(drawn[0][i].y, tick_y(svg, labels[i]), kPixel) << labels[i];
  }
  const double decade = tick_y(svg, "1") - tick_y(svg, "10");
  EXPECT_NEAR(tick_y(svg, "10") - tick_y(svg, "100"), decade, 2.0 * kPixel);
  EXPECT_NEAR(tick_y(svg, "1") - tick_y(svg, "2"), std::log10(2.0) * decade, 2.0 * kPixel);
  EXPECT_NEAR(drawn[0][4].y, tick_y(svg, "1") - 0.5 * decade, 2.0 * kPixel);
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
  const struct {
    bool log_y;
    std::vector<Point> points;
    std::vector<std::size_t> sizes;  // of the pieces
  } cases[] = {
      {true, {{0, 1}, {1, 10}, {2, 0}, {3, 10}, {4, 1}, {5, -3}, {6, 1}, {7, 10}}, {2, 2, 2}},
      {false, {{0, 1}, {1, 2}, {2, kNan}, {3, 1}, {4, 2}, {5, kInfinity}, {6, 1}}, {2, 2, 1}}};
  for (const auto& c : cases) {
    Panel panel = panel_of(c.points);
    panel.log_y = c.log_y;
    std::vector<std::size_t> sizes;
    for (const auto& piece : pieces(draw_chart("", {panel}, 1), kColours[0])) {
      sizes.push_back(piece.size());
    }
    EXPECT_EQ(sizes, c.sizes);
  }
}

TEST(Chart, NonFiniteValuesInterruptABand) {
  Panel panel;
  panel.bands.push_back({{0, 1, 2, 3, 4}, {0, 0, kNan, 0, 0}, {1, 1, 1, 1, 1}, "#123456"});
  const std::string svg = draw_chart("", {panel}, 1);
  EXPECT_EQ(count(svg, "fill=\"#123456\""), 2U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Chart, BandOnALogAxisReachesTheBottomFromZero) {
  Panel panel;
  panel.log_y = true;
  panel.bands.push_back({{0, 1}, {-1, 1}, {10, 10}, "#123456"});
  const std::string svg = draw_chart("", {panel}, 1);
  const auto d = matches(svg, "<path d=\"([^\"]*)\" fill=\"#123456\"");
  ASSERT_EQ(d.size(), 1U);
  const Box box = clip_box(svg);
  // along the high side, back along the low side: the last point is the one at zero
  EXPECT_NE(d[0].find(" L" + fixed(box.left, 1) + " " + fixed(box.bottom(), 1) + " Z"),
            std::string::npos)
      << d[0];
}

TEST(Chart, LevelsLieAtTheirValue) {
  Panel panel = panel_of({{0, 0}, {1, 10}});
  panel.levels.push_back({4.0, "four", {"#654321", 1.0}});
  const std::string svg = draw_chart("", {panel}, 1);
  const auto heights = matches(
      svg, "<line x1=\"" + fixed(clip_box(svg).left, 1) + "\" y1=\"([^\"]*)\"[^>]*\"#654321\"");
  ASSERT_EQ(heights.size(), 1U);
  EXPECT_NEAR(std::stod(heights[0]), tick_y(svg, "4"), kPixel);
  EXPECT_EQ(count(svg, ">four</text>"), 1U);
}

TEST(Chart, LabelsOfLevelsDoNotOverlap) {
  for (const double first : {0.0, 990.0}) {  // at the bottom there is no room below, here there is
    Panel panel = panel_of({{0, 0}, {1, 1000}});
    for (const double value : {0.5, 3.0, 1.0, 2.0}) {
      panel.levels.push_back({first + value, "level", {}});
    }
    const std::string svg = draw_chart("", {panel}, 1);
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
  const std::string svg = draw_chart("", {panel}, 1);
  const Box box = clip_box(svg);
  EXPECT_NEAR(box.top, tick_y(svg, "10"), kPixel);
  EXPECT_NEAR(box.bottom(), tick_y(svg, "0"), kPixel);
  const auto drawn = pieces(svg, kColours[0]);
  ASSERT_EQ(drawn.size(), 1U) << "a large value does not interrupt";
  EXPECT_LT(drawn[0][1].y, box.top);
  EXPECT_GT(drawn[0][3].y, box.bottom());
  const std::size_t begin = svg.find("<g clip-path=\"url(#clip1)\">");
  const std::size_t end = svg.find("</g>", begin);
  const std::size_t curve = svg.find("<path");
  ASSERT_NE(begin, std::string::npos);
  EXPECT_LT(begin, curve);
  EXPECT_LT(curve, end);
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
  Panel empty;
  Panel log_empty;
  log_empty.log_y = true;
  Panel all_nan = panel_of({{kNan, kNan}, {0, kNan}});
  Panel constant = panel_of({{2, 3}});
  Panel constant_log = constant;
  constant_log.log_y = true;
  Panel negative_log = panel_of({{0, -1}, {1, -2}});
  negative_log.log_y = true;
  Panel zero = panel_of({{0, 0}, {1, 0}});
  zero.from_zero = true;
  for (const Panel& panel :
       {empty, log_empty, all_nan, constant, constant_log, negative_log, zero}) {
    const std::string svg = draw_chart("t", {panel}, 1);
    EXPECT_EQ(malformed(svg), "");
    EXPECT_EQ(count(svg, "nan") + count(svg, "inf"), 0U) << svg;
  }
  EXPECT_EQ(malformed(draw_chart("", {}, 3)), "");
  EXPECT_EQ(malformed(draw_chart("", {empty}, 0)), "");
}

}  // namespace
}  // namespace rio::plot

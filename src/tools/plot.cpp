// SPDX-License-Identifier: BSD-3-Clause
// `rio plot`: estimates, and their errors if the truth is known, as one self-contained SVG file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "evaluate.hpp"
#include "outputs.hpp"
#include "plot/axes.hpp"
#include "plot/panel.hpp"
#include "plot/svg.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/eval/pairing.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::tools {

namespace {

using plot::Axes;
using plot::Legend;
using plot::Panel;
using plot::Point;
using plot::Range;
using plot::Stroke;
using plot::Svg;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// One path and how it is drawn.
struct Series {
  std::string label;
  Stroke stroke;
  eval::Trajectory poses;
  std::vector<eval::PosePair> pairs;  ///< with the truth, if given
};

Time time_of(const eval::StampedPose& pose) {
  return pose.time;
}
Time time_of(const eval::PosePair& pair) {
  return pair.estimate.time;
}

/// A point of each sample, as a curve that is interrupted where samples are missing, at intervals
/// far above the usual one, and where y jumps by more than `max_jump`.
template <class Sample, class PointOf>
std::vector<Point> curve_of(const std::vector<Sample>& samples, PointOf point_of,
                            double max_jump = kUnlimited) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    intervals.push_back(to_seconds(time_of(samples[i]) - time_of(samples[i - 1])));
  }
  const double longest = 5.0 * eval::statistics(intervals).median;
  std::vector<Point> curve;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Point point = point_of(samples[i]);
    if (i > 0 && (intervals[i - 1] > longest || std::abs(point.y - curve.back().y) > max_jump)) {
      curve.push_back({eval::kNan, eval::kNan});
    }
    curve.push_back(point);
  }
  return curve;
}

void draw_plan(Svg* svg, double left, double top, double size, const std::vector<Series>& all) {
  std::vector<std::vector<Point>> curves;
  Range x;
  Range y;
  for (const Series& series : all) {
    curves.push_back(curve_of(series.poses, [](const eval::StampedPose& pose) {
      return Point{pose.p.x(), pose.p.y()};
    }));
    for (const Point& point : curves.back()) {
      x.add(point.x);
      y.add(point.y);
    }
  }
  x = x.padded(0.05, 0.1);
  y = y.padded(0.05, 0.1);
  // a metre has the same length along both
  const double half = 0.5 * std::max(x.span(), y.span());
  for (Range* range : {&x, &y}) {
    const double centre = 0.5 * (range->low + range->high);
    *range = {centre - half, centre + half};
  }
  const Axes axes(svg, {left, top, size, size}, x, y);
  axes.draw("Plan view", "x [m]", "y [m]");
  for (std::size_t i = 0; i < all.size(); ++i) axes.curve(curves[i], all[i].stroke);
  for (const Series& series : all) {
    const Vector3d& first = series.poses.front().p;
    const Vector3d& last = series.poses.back().p;
    const Point start = axes.pixel(first.x(), first.y());
    const Point end = axes.pixel(last.x(), last.y());
    svg->circle(start, 5.0, "#ffffff", {series.stroke.colour, 2.0});
    svg->rectangle({end.x - 4.5, end.y - 4.5, 9.0, 9.0}, series.stroke.colour, {"#ffffff", 1.0});
  }
}

/// A quantity of all series over the time since `start` [s].
/// @param samples those of a series
/// @param smallest_span of the y axis
template <class Samples, class Value>
Panel over_time(const std::vector<Series>& all, Time start, Samples samples, Value value,
                double smallest_span, bool from_zero = false, double max_jump = kUnlimited) {
  Panel panel;
  for (const Series& series : all) {
    const auto point_of = [&](const auto& sample) {
      return Point{to_seconds(time_of(sample) - start), value(sample)};
    };
    panel.curves.push_back({"", curve_of(series.*samples, point_of, max_jump), series.stroke});
  }
  Range y = y_values(panel);
  if (from_zero) y.add(0.0);
  panel.y = y.padded(0.06, smallest_span);
  if (from_zero) panel.y->low = 0.0;
  return panel;
}

/// Every other one is thinner and dashed: one that lies upon another lets it show.
Stroke overlaid_stroke(std::size_t i) {
  Stroke stroke = plot::curve_stroke(i);
  stroke.dashed = i % 2 == 1;
  if (!stroke.dashed) stroke.width *= 1.5;
  return stroke;
}

/// Line samples and names, then the meaning of the markers; returns the position of the last line.
double draw_legend(Svg* svg, double left, double top, double right,
                   const std::vector<Series>& all) {
  Legend legend(svg, left, top, right);
  for (const Series& series : all) {
    std::string text = series.label;
    if (!series.pairs.empty()) {
      text += " (RMSE " + plot::fixed(eval::norm_of_rmse(series.pairs), 2) + " m";
      const double drift = eval::final_drift(series.pairs);
      if (std::isfinite(drift)) text += ", final drift " + plot::fixed(drift, 2) + " %";
      text += ")";
    }
    legend.line(text, series.stroke);
  }
  legend.entry("start, end", [svg](Point at) {
    svg->circle({at.x + 6.0, at.y}, 5.0, "#ffffff", {"#555555", 2.0});
    svg->rectangle({at.x + 19.5, at.y - 4.5, 9.0, 9.0}, "#555555", {"none", 0.0});
  });
  return legend.bottom();
}

/// All series, the truth (if `with_truth`) first.
std::string draw(const std::vector<Series>& all, bool with_truth) {
  Time start = all.back().poses.front().time;
  for (const Series& series : all) start = std::min(start, series.poses.front().time);
  std::vector<Panel> panels;
  const auto add = [&panels](const char* title, const char* unit, Panel panel) {
    panel.title = title;
    panel.y_label = unit;
    panels.push_back(std::move(panel));
  };
  const auto height = [](const eval::StampedPose& pose) { return pose.p.z(); };
  const auto distance = [](const eval::PosePair& pair) {
    return (pair.estimate.p - pair.truth.p).norm();
  };
  add("Height", "z [m]", over_time(all, start, &Series::poses, height, 0.2));
  if (with_truth) {
    add("Position error", "|error| [m]",
        over_time(all, start, &Series::pairs, distance, 0.02, true));
  }
  if (with_truth && has_attitude(all.front().poses)) {
    add("Yaw error", "error [deg]",
        over_time(all, start, &Series::pairs, eval::yaw_error, 0.2, false, 180.0));
  }
  Range time;
  for (const plot::Curve& curve : panels.front().curves) {
    for (const Point& point : curve.points) time.add(point.x);
  }
  time = time.padded(0.0, 0.1);
  panels.back().x_label = "time [s]";

  const double width = 1280.0;
  const double plan_size = 560.0;
  const double plan_left = 75.0;
  const double panel_left = 720.0;
  const double panel_width = width - panel_left - 25.0;
  const double gap = 38.0;
  Svg measure(width, 0.0);
  const double top = draw_legend(&measure, plan_left, 28.0, width - 25.0, all) + 50.0;

  Svg svg(width, top + plan_size + 55.0);
  draw_legend(&svg, plan_left, 28.0, width - 25.0, all);
  draw_plan(&svg, plan_left, top, plan_size, all);
  const double count = static_cast<double>(panels.size());
  const double panel_height = (plan_size - gap * (count - 1.0)) / count;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double panel_top = top + static_cast<double>(i) * (panel_height + gap);
    const Axes axes(&svg, {panel_left, panel_top, panel_width, panel_height}, time, *panels[i].y);
    axes.draw(panels[i].title, panels[i].x_label, panels[i].y_label);
    for (const plot::Curve& curve : panels[i].curves) axes.curve(curve.points, curve.stroke);
  }
  return svg.str();
}

/// The truth over the time that the estimates cover.
Series truth_series(const eval::Trajectory& truth, const std::vector<Series>& estimates) {
  Time first = Time::max();
  Time last = Time::min();
  for (const Series& series : estimates) {
    first = std::min(first, series.poses.front().time);
    last = std::max(last, series.poses.back().time);
  }
  Series result{"truth", {"#b4b4b4", 4.0}, {}, {}};
  for (const eval::StampedPose& pose : truth) {
    if (pose.time >= first && pose.time <= last) result.poses.push_back(pose);
  }
  if (result.poses.empty()) result.poses = truth;  // no pose in that time, since it is too sparse
  return result;
}

}  // namespace

void plot(const PlotArguments& arguments) {
  std::vector<std::string> inputs = arguments.estimates;
  inputs.push_back(arguments.truth);
  protect_inputs(inputs, {arguments.out});
  const std::filesystem::path out = arguments.out;
  if (out.has_extension() && out.extension() != ".svg") {
    throw std::runtime_error(fmt::format(
        "{0}: an SVG is drawn; name it {1}.svg, then for a PNG or PDF: rsvg-convert {1}.svg{2} -o "
        "{0} (package librsvg2-bin)",
        arguments.out, std::filesystem::path(out).replace_extension().string(),
        out.extension() == ".pdf" ? " -f pdf" : ""));
  }
  if (!arguments.labels.empty() && arguments.labels.size() != arguments.estimates.size()) {
    throw std::runtime_error("--label: " + std::to_string(arguments.labels.size()) + " names for " +
                             std::to_string(arguments.estimates.size()) + " estimates");
  }
  const std::vector<std::string> labels =
      arguments.labels.empty() ? default_labels(arguments.estimates) : arguments.labels;
  const bool with_truth = !arguments.truth.empty();
  const eval::Trajectory truth =
      with_truth ? path_of(arguments.truth, arguments.truth_topic, io::Attitude::kOptional)
                 : eval::Trajectory{};

  std::vector<Series> all;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    eval::Trajectory poses = path_of(arguments.estimates[i], arguments.topic);
    all.push_back({labels[i], overlaid_stroke(i), std::move(poses), {}});
  }
  std::vector<NamedPath> paths;
  for (const Series& series : all) paths.emplace_back(series.label, series.poses);
  if (with_truth) paths.emplace_back(arguments.truth, truth);
  expect_common_time(paths);
  for (std::size_t i = 0; with_truth && i < all.size(); ++i) {
    Series& series = all[i];
    series.pairs = lay_over(truth, arguments.align, &series.poses);
    if (series.pairs.size() < 2) {
      throw std::runtime_error(series.label + ": fewer than 2 poses have a true pose in " +
                               arguments.truth);
    }
  }
  if (with_truth) all.insert(all.begin(), truth_series(truth, all));
  write_text(arguments.out, draw(all, with_truth));
}

}  // namespace rio::tools

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
#include "plot/colours.hpp"
#include "plot/legend.hpp"
#include "plot/svg.hpp"
#include "rio/eval/alignment.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/eval/pairing.hpp"
#include "rio/io/text_file.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::tools {

namespace {

using plot::Axes;
using plot::Legend;
using plot::Point;
using plot::Range;
using plot::Stroke;
using plot::Svg;

/// One path and how it is drawn.
struct Series {
  std::string label;
  Stroke stroke;
  eval::Trajectory poses;
  std::vector<eval::PosePair> pairs;  ///< with the truth, if given
};

/// The points as a curve that is interrupted where samples are missing, at intervals far above the
/// usual one, and where y jumps by more than `max_jump`.
/// @param times of the points [s]
std::vector<Point> interrupted(const std::vector<double>& times, const std::vector<Point>& points,
                               double max_jump = std::numeric_limits<double>::infinity()) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  const double longest = 5.0 * eval::statistics(intervals).median;
  std::vector<Point> curve;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool breaks =
        i > 0 && (intervals[i - 1] > longest || std::abs(points[i].y - points[i - 1].y) > max_jump);
    if (breaks) curve.push_back({eval::kNan, eval::kNan});
    curve.push_back(points[i]);
  }
  return curve;
}

Time time_of(const eval::StampedPose& pose) {
  return pose.time;
}
Time time_of(const eval::PosePair& pair) {
  return pair.estimate.time;
}

/// A value of each sample over the time since `start` [s].
template <class Sample, class Value>
std::vector<Point> over_time(const std::vector<Sample>& samples, Time start, Value value,
                             double max_jump = std::numeric_limits<double>::infinity()) {
  std::vector<double> times;
  std::vector<Point> points;
  for (const Sample& sample : samples) {
    times.push_back(to_seconds(time_of(sample) - start));
    points.push_back({times.back(), value(sample)});
  }
  return interrupted(times, points, max_jump);
}

std::vector<Point> plan(const eval::Trajectory& poses) {
  std::vector<double> times;
  std::vector<Point> points;
  for (const eval::StampedPose& pose : poses) {
    times.push_back(to_seconds(pose.time - poses.front().time));
    points.push_back({pose.p.x(), pose.p.y()});
  }
  return interrupted(times, points);
}

/// File name without extension; with its folder if two would be equal.
std::vector<std::string> default_labels(const std::vector<std::string>& paths) {
  const auto name = [](std::filesystem::path path) {
    if (path.filename().empty()) path = path.parent_path();  // "run/" is the folder "run"
    return std::pair(path.parent_path().filename().string(), path.stem().string());
  };
  std::vector<std::string> labels;
  for (const std::string& path : paths) {
    const auto same = [&](const std::string& other) {
      return name(other).second == name(path).second;
    };
    const auto [folder, stem] = name(path);
    const bool shared = std::count_if(paths.begin(), paths.end(), same) > 1;
    labels.push_back(stem);
    if (shared && !folder.empty()) labels.back().insert(0, folder + "/");
  }
  return labels;
}

/// Both ranges grown so that a metre has the same length along x and y of a square panel.
void make_equal(Range* x, Range* y) {
  const double half = 0.5 * std::max(x->span(), y->span());
  for (Range* range : {x, y}) {
    const double centre = 0.5 * (range->low + range->high);
    *range = {centre - half, centre + half};
  }
}

void draw_plan(Svg* svg, double left, double top, double size, const std::vector<Series>& all) {
  std::vector<std::vector<Point>> curves;
  Range x;
  Range y;
  for (const Series& series : all) {
    curves.push_back(plan(series.poses));
    for (const Point& point : curves.back()) {
      x.add(point.x);
      y.add(point.y);
    }
  }
  x = x.padded(0.05, 0.1);
  y = y.padded(0.05, 0.1);
  make_equal(&x, &y);
  const Axes axes(svg, {left, top, size, size}, x, y);
  axes.draw("Plan view", "x [m]", "y [m]");
  for (std::size_t i = 0; i < all.size(); ++i) axes.curve(curves[i], all[i].stroke);
  for (const Series& series : all) {
    const Vector3d& first = series.poses.front().p;
    const Vector3d& last = series.poses.back().p;
    const Point start = axes.pixel(first.x(), first.y());
    const Point end = axes.pixel(last.x(), last.y());
    svg->circle(start, 5.0, "#ffffff", {series.stroke.colour, 2.0});
    svg->rectangle(end.x - 4.5, end.y - 4.5, 9.0, 9.0, series.stroke.colour, {"#ffffff", 1.0});
  }
}

/// A quantity over time: one curve for each series, in its order.
struct TimePanel {
  std::string title;
  std::string unit;
  std::vector<std::vector<Point>> curves;
  double smallest_span = 0.0;
  bool from_zero = false;
};

void draw_panel(Svg* svg, const plot::Box& box, const Range& time, const TimePanel& panel,
                const std::vector<Series>& all, bool last) {
  Range y;
  for (const auto& curve : panel.curves) {
    for (const Point& point : curve) y.add(point.y);
  }
  if (panel.from_zero) y.add(0.0);
  y = y.padded(0.06, panel.smallest_span);
  if (panel.from_zero) y.low = 0.0;
  const Axes axes(svg, box, time, y);
  axes.draw(panel.title, last ? "time [s]" : "", panel.unit);
  for (std::size_t i = 0; i < all.size(); ++i) axes.curve(panel.curves[i], all[i].stroke);
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
    svg->rectangle(at.x + 19.5, at.y - 4.5, 9.0, 9.0, "#555555", {"none", 0.0});
  });
  return legend.bottom();
}

/// All series, the truth (if `with_truth`) first.
std::string draw(const std::vector<Series>& all, bool with_truth) {
  Time start = all.back().poses.front().time;
  for (const Series& series : all) start = std::min(start, series.poses.front().time);
  Range time;
  TimePanel height{"Height", "z [m]", {}, 0.2, false};
  TimePanel position{"Position error", "|error| [m]", {}, 0.02, true};
  TimePanel yaw{"Yaw error", "error [deg]", {}, 0.2, false};
  for (const Series& series : all) {
    height.curves.push_back(
        over_time(series.poses, start, [](const eval::StampedPose& pose) { return pose.p.z(); }));
    position.curves.push_back(over_time(series.pairs, start, [](const eval::PosePair& pair) {
      return (pair.estimate.p - pair.truth.p).norm();
    }));
    yaw.curves.push_back(over_time(series.pairs, start, eval::yaw_error, 180.0));
    for (const Point& point : height.curves.back()) time.add(point.x);
  }
  time = time.padded(0.0, 0.1);
  std::vector<TimePanel> panels = {std::move(height)};
  if (with_truth) {
    panels.push_back(std::move(position));
    panels.push_back(std::move(yaw));
  }

  const double width = 1280.0;
  const double plan_size = 560.0;
  const double plan_left = 75.0;
  const double panel_left = 720.0;
  const double panel_width = width - panel_left - 25.0;
  const double gap = 38.0;
  Svg measure(width, 0.0);
  const double legend_end = draw_legend(&measure, plan_left, 28.0, width - 25.0, all);
  const double top = legend_end + 50.0;

  Svg svg(width, top + plan_size + 55.0);
  draw_legend(&svg, plan_left, 28.0, width - 25.0, all);
  draw_plan(&svg, plan_left, top, plan_size, all);
  const double count = static_cast<double>(panels.size());
  const double panel_height = (plan_size - gap * (count - 1.0)) / count;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double panel_top = top + static_cast<double>(i) * (panel_height + gap);
    draw_panel(&svg, {panel_left, panel_top, panel_width, panel_height}, time, panels[i], all,
               i + 1 == panels.size());
  }
  return svg.str();
}

/// The truth over the time that the estimates cover.
Series truth_series(const eval::Trajectory& truth, const std::vector<Series>& estimates) {
  Time first = estimates.front().poses.front().time;
  Time last = estimates.front().poses.back().time;
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
  const std::filesystem::path out = arguments.out;
  if (out.extension() == ".png" || out.extension() == ".pdf") {
    throw std::runtime_error(fmt::format(
        "{0}: an SVG is drawn; name it {1}.svg, then: rsvg-convert {1}.svg{2} -o {0} (package "
        "librsvg2-bin)",
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
  const eval::Trajectory truth = with_truth ? truth_of(arguments.truth) : eval::Trajectory{};

  std::vector<Series> all;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    eval::Trajectory poses = io::read_trajectory(arguments.estimates[i]);
    Series series{labels[i], overlaid_stroke(i), std::move(poses), {}};
    if (with_truth) {
      series.pairs = eval::associate(truth, series.poses).pairs;
      if (series.pairs.size() < 2) {
        throw std::runtime_error(arguments.estimates[i] +
                                 ": fewer than 2 poses have a true pose in " + arguments.truth);
      }
      const Pose T =
          eval::find_alignment(series.pairs, *eval::alignment_kind(arguments.align)).transform;
      series.pairs = eval::transformed(T, std::move(series.pairs));
      for (eval::StampedPose& pose : series.poses) pose = eval::transformed(T, pose);
    }
    all.push_back(std::move(series));
  }
  std::vector<NamedPath> paths;
  for (const Series& series : all) paths.emplace_back(series.label, series.poses);
  expect_common_time(paths);
  if (with_truth) all.insert(all.begin(), truth_series(truth, all));

  std::vector<std::string> inputs = arguments.estimates;
  inputs.push_back(arguments.truth);
  protect_inputs(inputs, {arguments.out});
  io::TextFile file(arguments.out);
  file.write(draw(all, with_truth));
  file.close();
}

}  // namespace rio::tools

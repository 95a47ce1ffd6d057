// SPDX-License-Identifier: BSD-3-Clause
// Xu, Huang, Shen, Yin, "Incorporating Point Uncertainty in Radar SLAM", on simulated flights: the
// benefit of the polar noise of each point (Table I), its correct size (Table II, Fig. 8), matching
// by probability against matching by distance (Fig. 7), comparison of estimators (Table III); the
// noise of points (Figs. 3 and 5).
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/figures.hpp"
#include "plot/chart.hpp"
#include "rio/models/detection.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 10;
constexpr int kLargestExponent = 3;  // of the scale of the covariances, Table II
constexpr const char* kPreset = "published-uncertainty";
constexpr const char* kFull = "full";  // the unchanged preset
constexpr const char* kByDistance = "full weights, Euclidean matching";
constexpr const char* kMahalanobis = "Mahalanobis";
constexpr const char* kDefault = "default, filter";
constexpr const char* kWithoutAny = "without any uncertainty";
constexpr const char* kWithoutRange = "without that of the range";
constexpr const char* kWithoutAngles = "without that of the angles";

/// Flights of a kind. Noise exactly as modelled; a room with all effects; and open ground, where
/// points are up to 40 m away and off by metres: there the noise of points differs most.
struct Family {
  const char* scenario;
  double length;  ///< [m]
};
constexpr Family kMatched{"monte-carlo", 40.0};
constexpr std::array kFamilies = {kMatched, Family{"indoor-1", 60.0}, Family{"outdoor", 100.0}};

Cases flights_of(const Family& family, const Settings& settings) {
  Cases cases = cases_of(family.scenario, settings.seeds_or(kSeeds));
  for (Case& c : cases) c.scenario.path.length = family.length;
  return cases;
}

void scale_sigmas(Options* o, double range, double angle) {
  o->radar.sigma_range *= range;
  o->radar.range_resolution *= range;
  o->radar.sigma_azimuth *= angle;
  o->radar.sigma_elevation *= angle;
}

/// The sigmas of range and angles times a factor each; matched by distance, since the gate of
/// matching by probability would reject nearly all pairs of points that are assumed exact.
Variant without(const char* name, double range, double angle) {
  return {name, kPreset, [range, angle](Options& o) {
            o.frontend.matching = Matching::kEuclidean;
            scale_sigmas(&o, range, angle);
          }};
}

/// Everything that is flown in all families. "A very small value" of a sigma in Table I: a tenth, a
/// hundredth of the variance. "Corrected" prevents the direction errors of the Doppler from
/// shrinking the velocity (models/doppler.hpp, E3), unlike the paper.
const Variants& variants() {
  constexpr double kSmall = 0.1;
  static const Variants all = {
      {"published-ekf", "published-ekf"},
      {"published-smoother", "published-smoother"},
      {kFull, kPreset},
      {"full, directions in the Doppler corrected", kPreset,
       [](Options& o) { o.update.doppler_directions = DopplerDirections::kCorrected; }},
      {"full, angle noise growing off boresight", kPreset,
       [](Options& o) { o.radar.angle_growth = true; }},
      {"full, without points", kPreset, [](Options& o) { o.update.use_landmarks = false; }},
      {"doppler-only", "doppler-only"},
      {kDefault, "default"},
      {"default, smoother", "default", use_smoother},
      {kByDistance, kPreset, [](Options& o) { o.frontend.matching = Matching::kEuclidean; }},
      without(kWithoutAny, kSmall, kSmall),
      without(kWithoutRange, kSmall, 1.0),
      without(kWithoutAngles, 1.0, kSmall),
      {kMahalanobis, kPreset, [](Options& o) { o.frontend.matching = Matching::kMahalanobis; }}};
  return all;
}

using Names = std::vector<std::string>;

/// The variants of Table III, the first nine.
Names estimators() {
  Names names;
  for (std::size_t i = 0; i < 9; ++i) names.push_back(variants()[i].name);
  return names;
}

/// Table II: Sigma times 2^exponent, the Doppler's own noise unchanged.
std::string scaled_name(int exponent) {
  return exponent == 0 ? kFull : fmt::format("covariances times 2^{}", exponent);
}
Variants scalings() {
  Variants all;
  for (int k = -kLargestExponent; k <= kLargestExponent; ++k) {
    if (k == 0) continue;
    const double factor = std::sqrt(std::pow(2.0, k));
    all.push_back(
        {scaled_name(k), kPreset, [factor](Options& o) { scale_sigmas(&o, factor, factor); }});
  }
  return all;
}

/// One of the four errors that evo prints by default.
struct PoseError {
  const char* name;
  double Score::*value;
  int decimals;
};
constexpr std::array kErrors = {
    PoseError{"APE [m]", &Score::ape, 2}, PoseError{"APE [deg]", &Score::ape_angle, 2},
    PoseError{"RPE [m]", &Score::rpe, 4}, PoseError{"RPE [deg]", &Score::rpe_angle, 3}};

/// The first `count` errors, of the first `compared` also how much more they are than with `full`.
std::vector<Column> error_columns(std::size_t count, std::size_t compared, bool of_scalings) {
  std::vector<Column> columns;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [name, value, decimals] = kErrors[i];
    columns.push_back(spread_of(name, value, decimals));
    const std::string unit = std::string(name).substr(4);
    const std::string head = of_scalings ? "more than at 0" : "more than full " + unit;
    if (i < compared) columns.push_back(change_of(head, value, decimals));
  }
  return columns;
}

/// A row for each family and variant.
std::string table_of(const Outcomes& runs, const std::string& what, const Names& names,
                     const std::vector<Column>& columns) {
  MarkdownTable table(head_of({"flights", what}, columns));
  for (const Family& family : kFamilies) {
    for (const std::string& name : names) {
      table.add(row_of({family.scenario, name}, columns, select(runs, family.scenario, name),
                       select(runs, family.scenario, kFull)));
    }
  }
  return table.text();
}

std::string scaling_table(const Outcomes& runs) {
  const std::vector<Column> columns = error_columns(4, 4, true);
  MarkdownTable table(head_of({"alpha"}, columns));
  for (int k = -kLargestExponent; k <= kLargestExponent; ++k) {
    table.add(row_of({fmt::format("{}", k)}, columns,
                     select(runs, kMatched.scenario, scaled_name(k)),
                     select(runs, kMatched.scenario, kFull)));
  }
  return table.text();
}

/// Means over the flights by alpha, in terms of that at 0.
Curve relative(const Outcomes& runs, double Score::*value) {
  const double full = Spread::of(select(runs, kMatched.scenario, kFull), value).mean;
  Curve points;
  for (int k = -kLargestExponent; k <= kLargestExponent; ++k) {
    const Scores scores = select(runs, kMatched.scenario, scaled_name(k));
    points.push_back({static_cast<double>(k), Spread::of(scores, value).mean / full});
  }
  return points;
}

/// Alpha of the least value of each error.
std::string least_of_scalings(const Outcomes& runs) {
  std::vector<std::string> texts;
  for (const PoseError& error : kErrors) {
    const Curve points = relative(runs, error.value);
    const auto least =
        std::min_element(points.begin(), points.end(),
                         [](const plot::Point& a, const plot::Point& b) { return a.y < b.y; });
    texts.push_back(fmt::format("{} at {:+.0f}", error.name, least->x));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string scaling_chart(const Outcomes& runs) {
  plot::Panel p = panel("", "alpha: covariances times 2^alpha", "error over that at 0");
  for (const PoseError& error : kErrors) {
    p.curves.push_back(
        {error.name, relative(runs, error.value), plot::curve_stroke(p.curves.size())});
  }
  return plot::draw_chart("Sigmas of range and angles off from those simulated", {p}, 1);
}

/// The three-sigma ellipse of a point in the plane of x and another axis.
plot::Curve ellipse(const char* label, const Vector3d& point, const Matrix3d& covariance, int axis,
                    const plot::Stroke& stroke) {
  constexpr int kSteps = 48;
  const std::array shown = {0, axis};
  const Eigen::Matrix2d root = covariance(shown, shown).llt().matrixL();
  plot::Curve curve{label, {}, stroke};
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSteps;
    const Eigen::Vector2d off = 3.0 * root * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    curve.points.push_back({point.x() + off.x(), point[axis] + off.y()});
  }
  return curve;
}

/// Points by range and angle: their polar noise from above, and from the side beside the same
/// noise in all directions.
std::string noise_chart() {
  Options options;
  if (!preset(kPreset, &options)) throw std::logic_error("no such preset");
  const auto seen = [&](double range, double azimuth, double elevation) {
    const Vector3d u(std::cos(elevation) * std::cos(azimuth),
                     std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    return make_detection({.point_S = range * u}, options.radar);
  };
  const Matrix3d everywhere =
      point_covariance(seen(4.0, 0.0, 0.0)).trace() / 3.0 * Matrix3d::Identity();
  plot::Panel above = panel("from above", "x [m]", "y [m]");
  plot::Panel side = panel("from the side", "x [m]", "z [m]");
  for (const double range : {2.0, 4.0, 6.0, 8.0}) {
    for (const double angle : {-0.7, -0.35, 0.0, 0.35, 0.7}) {
      const Detection aside = seen(range, angle, 0.0);
      const Detection up = seen(range, 0.0, 0.5 * angle);
      above.curves.push_back(
          ellipse("polar", aside.point_S, point_covariance(aside), 1, plot::curve_stroke(0)));
      side.curves.push_back(
          ellipse("polar", up.point_S, point_covariance(up), 2, plot::curve_stroke(0)));
      side.curves.push_back(
          ellipse("the same in all directions", up.point_S, everywhere, 2, plot::curve_stroke(1)));
    }
  }
  return plot::draw_chart("Noise of points: three sigmas", {above, side}, 2);
}

}  // namespace

Result uncertainty(const Settings& settings) {
  Outcomes runs;
  FlownFlights flown;  // Fig. 6: with and without the noise of the points
  for (const Family& family : kFamilies) {
    flown.push_back({family.scenario, {kFull, kWithoutAny}});
    Variants all = variants();
    for (Variant& v : scalings()) {
      if (kMatched.scenario == std::string_view(family.scenario)) all.push_back(std::move(v));
    }
    const auto each = [&flown](const Case& c, const Variant& v, const Trial& trial) {
      keep(c, v, trial, &flown);
    };
    for (Outcome& run : run_campaign(flights_of(family, settings), all, settings, each)) {
      runs.push_back(std::move(run));
    }
  }
  const Names weights = {kFull, kByDistance, kWithoutAny, kWithoutRange, kWithoutAngles};
  const Names matchings = {kFull, kByDistance, kMahalanobis, kDefault};
  const std::string text = fmt::format(
      "{} flights of a kind: mean (worst) ± standard deviation; differences to `full`, the preset "
      "`{}`,\nin the same flights ± their standard error. APE and RPE as evo computes them by "
      "default: not aligned, from scan to scan.\n\n"
      "Weights. \"Without\" an uncertainty, its sigma is a tenth; matched by distance, because "
      "points taken as exact pass no check by probability,\nso that the second row is what the "
      "weights alone are compared with.\n\n{}\n"
      "Size. All covariances of range and angles times 2^alpha, flights with matched noise. "
      "Least: {}.\n\n{}\n"
      "Matching; `full` matches by probability.\n\n{}\n"
      "Estimators.\n\n{}",
      settings.seeds_or(kSeeds), kPreset,
      table_of(runs, "estimator", weights, error_columns(4, 2, false)), least_of_scalings(runs),
      scaling_table(runs), table_of(runs, "matching", matchings, error_columns(1, 1, false)),
      table_of(runs, "estimator", estimators(), error_columns(4, 2, false)));
  return {text,
          {{"uncertainty.csv", outcomes_as_csv(runs)},
           {"uncertainty.svg", scaling_chart(runs)},
           {"uncertainty-points.svg", noise_chart()},
           {"uncertainty-paths.svg",
            chart_of_paths("With and without the uncertainty of the points", flown)}}};
}

}  // namespace rio::experiment

// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/figures.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "plot/chart.hpp"
#include "plot/colours.hpp"
#include "rio/models/detection.hpp"

namespace rio::experiment {

namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};
// points of a curve, at most
constexpr std::size_t kOverTime = 300;
constexpr std::size_t kOfPath = 1200;

/// The value of steps evenly spread over the trial.
template <class Value>
std::vector<plot::Point> sampled(const Trial& trial, std::size_t most, const Value& value) {
  std::vector<plot::Point> points;
  const std::size_t every = 1 + trial.steps.size() / most;
  for (std::size_t i = 0; i < trial.steps.size(); i += every) {
    points.push_back(value(trial.steps[i]));
  }
  return points;
}

double seconds(const Trial& trial, const Step& step) {
  return to_seconds(step.truth.time - trial.steps.front().truth.time);
}

plot::Stroke truth_stroke() {
  return {"#000000", 1.2};
}

/// Truth and estimates; place(trial, step, state) is the point of a state.
template <class Place>
std::vector<plot::Curve> curves(const FlownFlight& flight, std::size_t most, const Place& place) {
  const Trial& first = flight.trials.front();
  std::vector<plot::Curve> all = {
      {"truth", sampled(first, most, [&](const Step& s) { return place(first, s, s.truth); }),
       truth_stroke()}};
  for (std::size_t i = 0; i < flight.trials.size(); ++i) {
    const Trial& trial = flight.trials[i];
    all.push_back({flight.estimators[i],
                   sampled(trial, most, [&](const Step& s) { return place(trial, s, s.estimate); }),
                   plot::curve_stroke(i)});
  }
  return all;
}

/// The three-sigma ellipse of a point in the plane of x and another axis.
plot::Curve ellipse(const std::string& label, const Vector3d& point, const Matrix3d& covariance,
                    int axis, std::size_t colour) {
  constexpr int kSteps = 48;
  Eigen::Matrix2d plane;
  plane << covariance(0, 0), covariance(0, axis), covariance(axis, 0), covariance(axis, axis);
  const Eigen::Matrix2d root = plane.llt().matrixL();
  plot::Curve curve{label, {}, plot::curve_stroke(colour)};
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSteps;
    const Eigen::Vector2d off = 3.0 * root * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    curve.points.push_back({point.x() + off.x(), point[axis] + off.y()});
  }
  return curve;
}

/// A small cross at a point.
plot::Curve cross(const std::string& label, double x, double y, std::size_t colour) {
  constexpr double kArm = 0.05;  // [m]
  const double nan = std::nan("");
  return {label,
          {{x - kArm, y}, {x + kArm, y}, {nan, nan}, {x, y - kArm}, {x, y + kArm}},
          plot::curve_stroke(colour)};
}

}  // namespace

FlownFlight fly_all(const Case& flight, const std::vector<Variant>& estimators) {
  FlownFlight flown{flight.group, {}, {}};
  const sim::Flight simulated = sim::simulate_flight(flight.scenario);
  for (const Variant& v : estimators) {
    flown.estimators.push_back(v.name);
    flown.trials.push_back(fly(simulated, options_of(simulated, v)));
  }
  return flown;
}

std::string chart_of_paths(const std::string& title, const std::vector<FlownFlight>& flights) {
  std::vector<plot::Panel> panels;
  for (const FlownFlight& flight : flights) {
    for (const int up : {1, 2}) {
      plot::Panel panel;
      panel.title = flight.name + (up == 1 ? ", from above" : ", from the side");
      panel.x_label = "x [m]";
      panel.y_label = std::string(kAxes[up]) + " [m]";
      panel.curves =
          curves(flight, kOfPath, [up](const Trial&, const Step&, const NavState& state) {
            return plot::Point{state.p_WB.x(), state.p_WB[up]};
          });
      panels.push_back(std::move(panel));
    }
  }
  return plot::draw_chart(title, panels, 2);
}

std::string chart_of_positions(const std::string& title, const std::vector<FlownFlight>& flights) {
  std::vector<plot::Panel> panels;
  for (const FlownFlight& flight : flights) {
    for (int axis = 0; axis < 3; ++axis) {
      plot::Panel panel;
      panel.title = flight.name;
      panel.x_label = "time [s]";
      panel.y_label = std::string(kAxes[axis]) + " [m]";
      panel.curves =
          curves(flight, kOverTime, [axis](const Trial& t, const Step& s, const NavState& state) {
            return plot::Point{seconds(t, s), state.p_WB[axis]};
          });
      panels.push_back(std::move(panel));
    }
  }
  return plot::draw_chart(title, panels, 3);
}

std::string chart_of_errors(const std::string& title, const FlownFlight& flight) {
  std::vector<plot::Panel> panels;
  for (std::size_t i = 0; i < flight.trials.size(); ++i) {
    const Trial& trial = flight.trials[i];
    for (int axis = 0; axis < 3; ++axis) {
      plot::Panel panel;
      panel.title = flight.estimators[i];
      panel.x_label = "time [s]";
      panel.y_label = std::string("error of ") + kAxes[axis] + " [m]";
      const auto error = sampled(trial, kOverTime, [&](const Step& s) {
        return plot::Point{seconds(trial, s), s.estimate.p_WB[axis] - s.truth.p_WB[axis]};
      });
      const auto sigmas = [&](double count) {
        return sampled(trial, kOverTime, [&, count](const Step& s) {
          const int k = body::kPosition + axis;
          return plot::Point{seconds(trial, s), count * std::sqrt(s.covariance(k, k))};
        });
      };
      panel.curves = {{"error", error, plot::curve_stroke(0)},
                      {"three sigmas", sigmas(3.0), truth_stroke()},
                      {"", sigmas(-3.0), truth_stroke()}};
      panels.push_back(std::move(panel));
    }
  }
  return plot::draw_chart(title, panels, 3);
}

std::string chart_of_point_noise(const RadarOptions& radar) {
  plot::Panel above{"polar noise, from above", "x [m]", "y [m]", {}, {}, {}};
  plot::Panel side{"polar and Cartesian noise, from the side", "x [m]", "z [m]", {}, {}, {}};
  plot::Panel match{"the likelier landmark is not the nearer one", "x [m]", "y [m]", {}, {}, {}};
  const auto seen = [&](double range, double azimuth, double elevation) {
    const Vector3d u(std::cos(elevation) * std::cos(azimuth),
                     std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    return make_detection({.point_S = range * u}, radar);
  };
  const Matrix3d everywhere =
      point_covariance(seen(4.0, 0.0, 0.0)).trace() / 3.0 * Matrix3d::Identity();
  for (const double range : {2.0, 4.0, 6.0, 8.0}) {
    for (const double angle : {-0.7, -0.35, 0.0, 0.35, 0.7}) {
      const Detection aside = seen(range, angle, 0.0);
      above.curves.push_back(ellipse("polar", aside.point_S, point_covariance(aside), 1, 0));
      if (std::abs(angle) > 0.5) continue;
      const Detection up = seen(range, 0.0, 0.7 * angle);
      side.curves.push_back(ellipse("polar", up.point_S, point_covariance(up), 2, 0));
      side.curves.push_back(ellipse("Cartesian", up.point_S, everywhere, 2, 1));
    }
  }
  const Detection point = seen(6.0, 0.0, 0.0);
  const double aside = 2.0 * 6.0 * radar.sigma_azimuth;
  const double behind = 5.0 * radar.sigma_range;
  match.curves = {ellipse("polar", point.point_S, point_covariance(point), 1, 0),
                  cross("detection", 6.0, 0.0, 2), cross("likelier landmark", 6.0, aside, 3),
                  cross("nearer landmark", 6.0 + behind, 0.0, 1)};
  return plot::draw_chart("Noise of points: three sigmas", {above, side, match}, 3);
}

}  // namespace rio::experiment

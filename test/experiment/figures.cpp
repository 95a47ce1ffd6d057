// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/figures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rio::experiment {

namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};
// points of a curve, at most
constexpr std::size_t kOverTime = 300;
constexpr std::size_t kOfPath = 1200;

const plot::Stroke kTruth{"#000000", 1.2};

/// The value of steps evenly spread over the trial, given their time since the first one [s].
template <class Value>
std::vector<plot::Point> sampled(const Trial& trial, std::size_t most, const Value& value) {
  std::vector<plot::Point> points;
  const std::size_t every = 1 + trial.steps.size() / most;
  for (std::size_t i = 0; i < trial.steps.size(); i += every) {
    const Step& step = trial.steps[i];
    const double t = to_seconds(step.truth.time - trial.steps.front().truth.time);
    points.push_back(value(t, step));
  }
  return points;
}

/// Truth and estimates; place(t, state) is the point of a state.
template <class Place>
std::vector<plot::Curve> curves(const FlownFlight& flight, std::size_t most, const Place& place) {
  const auto truth = [&](double t, const Step& s) { return place(t, s.truth); };
  const auto estimate = [&](double t, const Step& s) { return place(t, s.estimate); };
  std::vector<plot::Curve> all = {{"truth", sampled(flight.trials.front(), most, truth), kTruth}};
  for (std::size_t i = 0; i < flight.trials.size(); ++i) {
    all.push_back(
        {flight.estimators[i], sampled(flight.trials[i], most, estimate), plot::curve_stroke(i)});
  }
  return all;
}

}  // namespace

plot::Panel panel(const std::string& title, const std::string& x_label,
                  const std::string& y_label) {
  plot::Panel panel;
  panel.title = title;
  panel.x_label = x_label;
  panel.y_label = y_label;
  return panel;
}

void keep(const Case& c, const Variant& variant, const Trial& trial, FlownFlights* flights) {
  for (FlownFlight& flight : *flights) {
    if (flight.name != c.group || c.scenario.seed != 1) continue;
    flight.trials.resize(flight.estimators.size());
    for (std::size_t i = 0; i < flight.trials.size(); ++i) {
      if (flight.estimators[i] == variant.name) flight.trials[i] = trial;
    }
  }
}

std::string chart_of_paths(const std::string& title, const FlownFlights& flights) {
  std::vector<plot::Panel> panels;
  for (const FlownFlight& flight : flights) {
    for (const int up : {1, 2}) {
      panels.push_back(panel(flight.name + (up == 1 ? ", from above" : ", from the side"), "x [m]",
                             std::string(kAxes[up]) + " [m]"));
      panels.back().curves = curves(flight, kOfPath, [up](double, const NavState& x) {
        return plot::Point{x.p_WB.x(), x.p_WB[up]};
      });
    }
  }
  return plot::draw_chart(title, panels, 2);
}

std::string chart_of_positions(const std::string& title, const FlownFlights& flights) {
  std::vector<plot::Panel> panels;
  for (const FlownFlight& flight : flights) {
    for (int axis = 0; axis < 3; ++axis) {
      panels.push_back(panel(flight.name, "time [s]", std::string(kAxes[axis]) + " [m]"));
      panels.back().curves = curves(flight, kOverTime, [axis](double t, const NavState& x) {
        return plot::Point{t, x.p_WB[axis]};
      });
    }
  }
  return plot::draw_chart(title, panels, 3);
}

std::string chart_of_errors(const std::string& title, const FlownFlight& flight) {
  std::vector<plot::Panel> panels;
  for (std::size_t i = 0; i < flight.trials.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto error = [axis](double t, const Step& s) {
        return plot::Point{t, s.estimate.p_WB[axis] - s.truth.p_WB[axis]};
      };
      const auto sigmas = [axis, &flight, i](double count) {
        const int k = body::kPosition + axis;
        return sampled(flight.trials[i], kOverTime, [count, k](double t, const Step& s) {
          return plot::Point{t, count * std::sqrt(s.covariance(k, k))};
        });
      };
      panels.push_back(
          panel(flight.estimators[i], "time [s]", std::string("error of ") + kAxes[axis] + " [m]"));
      panels.back().curves = {
          {"error", sampled(flight.trials[i], kOverTime, error), plot::curve_stroke(0)},
          {"three sigmas", sigmas(3.0), kTruth},
          {"", sigmas(-3.0), kTruth}};
    }
  }
  return plot::draw_chart(title, panels, 3);
}

void add_mean_curve(const std::vector<Curve>& runs, const std::string& name, plot::Panel* panel) {
  plot::Curve mean{name, {}, plot::curve_stroke(panel->curves.size())};
  plot::Band band;
  band.colour = mean.stroke.colour;
  for (std::size_t i = 0;; ++i) {
    std::vector<double> values;
    double x = 0.0;
    for (const Curve& run : runs) {
      if (i >= run.size()) continue;
      values.push_back(run[i].y);
      x = run[i].x;
    }
    if (values.size() < std::min<std::size_t>(2, runs.size()) || values.empty()) break;
    const Spread s = Spread::of(values);
    mean.points.push_back({x, s.mean});
    band.x.push_back(x);
    band.low.push_back(s.mean - s.std);
    band.high.push_back(s.mean + s.std);
  }
  panel->curves.push_back(std::move(mean));
  panel->bands.push_back(std::move(band));
}

}  // namespace rio::experiment

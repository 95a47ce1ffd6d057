// SPDX-License-Identifier: BSD-3-Clause
// The figures of the papers for simulated flights: paths, positions over time, errors with bounds.
#pragma once

#include <string>
#include <vector>

#include "experiment/campaign.hpp"
#include "plot/chart.hpp"

namespace rio::experiment {

/// A flight as several estimators see it.
struct FlownFlight {
  std::string name;
  std::vector<std::string> estimators;
  std::vector<Trial> trials{};  ///< one per estimator
};
using FlownFlights = std::vector<FlownFlight>;

/// Of a campaign: puts the trial into the flight that bears the name of the case, if its seed is 1
/// and the variant is one of the estimators.
void keep(const Case& c, const Variant& variant, const Trial& trial, FlownFlights* flights);

/// Plan and side view of each flight, truth and estimates (Michalczyk et al. 2023, Fig. 5; 2024,
/// Fig. 5; Xu et al., Fig. 6).
std::string chart_of_paths(const std::string& title, const FlownFlights& flights);

/// x, y and z over time, a row per flight (Michalczyk et al. 2024, Fig. 6 to 8).
std::string chart_of_positions(const std::string& title, const FlownFlights& flights);

/// Errors of x, y and z over time with their bounds of three sigmas, a row per estimator.
std::string chart_of_errors(const std::string& title, const FlownFlight& flight);

plot::Panel panel(const std::string& title, const std::string& x_label, const std::string& y_label);

/// The values of one run.
using Curve = std::vector<plot::Point>;

/// Mean and one standard deviation over the runs, as far as two of them go, or the only one.
void add_mean_curve(const std::vector<Curve>& runs, const std::string& name, plot::Panel* panel);

}  // namespace rio::experiment

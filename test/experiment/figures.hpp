// SPDX-License-Identifier: BSD-3-Clause
// The figures of the papers for simulated flights: paths, positions over time, errors with bounds.
#pragma once

#include <string>
#include <vector>

#include "experiment/campaign.hpp"

namespace rio::experiment {

/// A flight as several estimators see it.
struct FlownFlight {
  std::string name;
  std::vector<std::string> estimators;
  std::vector<Trial> trials;  ///< one per estimator
};

FlownFlight fly_all(const Case& flight, const std::vector<Variant>& estimators);

/// Plan and side view of each flight, truth and estimates (Michalczyk et al. 2023, Fig. 5; 2024,
/// Fig. 5; Xu et al., Fig. 6).
std::string chart_of_paths(const std::string& title, const std::vector<FlownFlight>& flights);

/// x, y and z over time, a row per flight (Michalczyk et al. 2024, Fig. 6 to 8).
std::string chart_of_positions(const std::string& title, const std::vector<FlownFlight>& flights);

/// Errors of x, y and z over time with their bounds of three sigmas, a row per estimator.
std::string chart_of_errors(const std::string& title, const FlownFlight& flight);

/// The three-sigma ellipses of points by the options: polar noise from above; from the side, polar
/// and the same in all axes; a likelier landmark that is not the nearer one (Xu et al., Fig. 5a, 5b
/// and 3).
std::string chart_of_point_noise(const RadarOptions& radar);

}  // namespace rio::experiment

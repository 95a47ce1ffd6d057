// SPDX-License-Identifier: BSD-3-Clause
// The simulated twin of a recording.
#pragma once

#include <string>

#include "experiment/recording.hpp"
#include "rio/sim/scenario.hpp"

namespace rio::experiment {

/// A scenario of the catalogue, or of a file. @throws std::runtime_error if there is no such
sim::Scenario scenario_of(const std::string& name);

/// The scenario with the properties measured directly from a recording; vibration and strength of
/// the echoes are a first guess.
sim::Scenario as_recorded(const Recording& recording, sim::Scenario scenario);

/// A simulated recording; its motion is that of the truth, from the speed that the radar detects.
struct Twin {
  io::Dataset data;
  Motion motion;
};

/// A flight of the scenario, as_recorded(), along the reference if there is one. Its rms of
/// vibration and median of points a scan are fitted to those of the recording in some rounds. The
/// estimator has the same configuration as for the recording.
/// @throws std::runtime_error if the reference is not a valid path
Twin twin_of(const Recording& recording, const sim::Scenario& scenario);

}  // namespace rio::experiment

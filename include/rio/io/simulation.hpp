// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights: scenario files (YAML nested as in rio/sim/scenario_fields.hpp, SI numbers or
// "2 deg", "5 cm"), and flights as recordings.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "rio/io/dataset.hpp"
#include "rio/sim/flight.hpp"
#include "rio/sim/scenario.hpp"

namespace rio::io {

/// The scenario of the catalogue with this name, or else the one in this file: its top-level
/// `scenario` key names the base in the catalogue that its values override; without it the base is
/// the default scenario. A relative `path.file` is relative to the folder of the file.
/// @throws std::runtime_error "FILE:LINE: ..." for unknown and duplicate keys, wrong types, units
/// and ranges; "FILE: ..." for inconsistent values; with the list of names if it is neither a name
/// nor a file
sim::Scenario load_scenario(const std::string& name_or_file);

/// Every value with its unit and meaning as a comment; reads back to the same scenario, except for
/// Scenario::start.
std::string scenario_as_yaml(const sim::Scenario& scenario);

/// Flies the path recorded in `path.file`, smoothed by a spline, or a random one if that is empty.
/// @throws std::runtime_error if the recorded path cannot be read or flown, or if the disturbances
/// leave no sample or no scan
sim::Flight fly_scenario(const sim::Scenario& scenario,
                         const std::function<void(std::size_t, std::size_t)>& each = {});

/// The sensor file of the simulated radar.
/// @param configured_T_BS the mounting as configured
RadarInfo radar_info_of(const sim::RadarModel& model, const Pose& configured_T_BS);

/// Samples, scans, truth and sensor files of a flight with one radar.
Dataset dataset_of(const sim::Flight& flight);

}  // namespace rio::io

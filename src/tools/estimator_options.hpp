// SPDX-License-Identifier: BSD-3-Clause
// The estimator options from the command line, an option file and the sensor files.
#pragma once

#include <string>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::tools {

/// Values of options that a user gives.
struct OptionValues {
  std::string config;            ///< option file
  std::vector<std::string> set;  ///< "KEY=VALUE", after the file
};

/// Overrides `options` by the sensor properties, then by the values of the file, if one is given,
/// then by the settings. Throws std::runtime_error.
/// @return for each value of the file that differs from the sensor files, "FILE overrides the
/// sensor files: KEY = NEW (OLD)"
std::vector<std::string> tell_sensors_and_file(const io::Dataset& sensors,
                                               const OptionValues& values, Options* options);

/// The defaults with these overrides, for commands without presets; notes overridden values on
/// stderr.
Options options_of(const io::Dataset& sensors, const OptionValues& values);

struct EstimatorArguments : OptionValues {
  std::string preset;   ///< overrides that of the file
  std::string backend;  ///< ekf or smoother; overrides both
};

/// Preset, then the sensor properties, then the values of the file, then the back-end of the
/// command line. Sensor properties changed by the file are noted on stderr. Throws
/// std::runtime_error.
/// @param base the options that the preset modifies
Options make_options(const EstimatorArguments& arguments, const io::Dataset& sensors,
                     Options base = {});

}  // namespace rio::tools

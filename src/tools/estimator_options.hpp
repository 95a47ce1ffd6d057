// SPDX-License-Identifier: BSD-3-Clause
// The estimator options from the command line, an option file and the sensor files.
#pragma once

#include <string>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::tools {

struct EstimatorArguments {
  std::string config;   ///< option file
  std::string preset;   ///< overrides that of the file
  std::string backend;  ///< ekf or smoother; overrides both
  /// The texts of further option files, each overrides those before and `config`.
  std::vector<std::string> values{};
};

/// Overrides `options` by the sensor properties, then by the values of the file and the texts.
/// Throws std::runtime_error.
/// @return for each value that differs from the sensor files, "FILE overrides the sensor files: KEY
/// = NEW (OLD)"
std::vector<std::string> tell_sensors_and_values(const io::Dataset& sensors,
                                                 const EstimatorArguments& arguments,
                                                 Options* options);

/// The defaults with these overrides, for commands without presets; notes overridden values on
/// stderr.
Options options_of(const io::Dataset& sensors, const std::string& file);

/// Preset, then the sensor properties, then the values of file and texts, then the back-end of the
/// command line. Throws std::runtime_error.
/// @param base the options that the preset modifies
/// @param notes receives the sensor properties that were overridden; if null, stderr does
Options make_options(const EstimatorArguments& arguments, const io::Dataset& sensors,
                     Options base = {}, std::vector<std::string>* notes = nullptr);

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// The options of the estimator from presets, option files, the sensor files of a recording and the
// command line.
#pragma once

#include <string>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::tools {

/// Values of options that a user gives; each overrides those before.
struct OptionValues {
  std::string config{};              ///< option file
  std::vector<std::string> texts{};  ///< the texts of further option files
  std::vector<std::string> set{};    ///< "KEY=VALUE"
};

struct EstimatorArguments : OptionValues {
  std::string preset{};   ///< overrides that of file and texts
  std::string backend{};  ///< ekf or smoother; overrides both
};

/// Overrides `options` by the sensor properties, then by the values of the user. Throws
/// std::runtime_error.
/// @return for each value of file and texts that differs from the sensor files, "FILE overrides the
/// sensor files: KEY = NEW (OLD)"
std::vector<std::string> tell_sensors_and_values(const io::Dataset& sensors,
                                                 const OptionValues& values, Options* options);

/// The defaults with these overrides, for commands without presets; notes overridden values on
/// stderr.
Options options_of(const io::Dataset& sensors, const OptionValues& values);

/// Preset, then the sensor properties, then the values of the user, then the back-end of the
/// command line. Throws std::runtime_error.
/// @param base the options that the preset modifies
/// @param notes receives the sensor properties that were overridden; if null, stderr does
Options make_options(const EstimatorArguments& arguments, const io::Dataset& sensors,
                     Options base = {}, std::vector<std::string>* notes = nullptr);

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// The options that the estimator flies with: preset, sensor files, option files, settings.
#pragma once

#include <string>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::io {

/// Values of options that a user gives; each overrides those before.
struct OptionValues {
  std::string config{};              ///< option file
  std::vector<std::string> texts{};  ///< the texts of further option files
  std::vector<std::string> set{};    ///< "KEY=VALUE"
};

struct EstimatorArguments : OptionValues {
  std::string preset{};   ///< overrides that of file and texts; that of `set` overrides it
  std::string backend{};  ///< ekf or smoother; overrides both
};

/// Overrides `options` by the sensor properties, then by the values of the user. Throws
/// std::runtime_error.
/// @return for each value of file and texts that differs from the sensor files, "FILE overrides the
/// sensor files: KEY = NEW (OLD)"
std::vector<std::string> tell_sensors_and_values(const Dataset& sensors, const OptionValues& values,
                                                 Options* options);

/// Preset, then the sensor properties, then the values of the user, then the back-end. Throws
/// std::runtime_error.
/// @param base the options that the preset modifies
/// @param notes receives the sensor properties that were overridden
Options flown_options(const EstimatorArguments& arguments, const Dataset& sensors, Options base,
                      std::vector<std::string>* notes);

}  // namespace rio::io

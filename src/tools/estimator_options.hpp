// SPDX-License-Identifier: BSD-3-Clause
// The options that a command line, an option file and the sensor files make together.
#pragma once

#include <string>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::tools {

/// Puts on top of `options` what is known of the sensors, then the values of the file, if one is
/// named. Throws std::runtime_error.
/// @return of each value of the file that differs from what the sensors tell, "FILE overrides the
/// sensor files: KEY = NEW (OLD)"
std::vector<std::string> tell_sensors_and_file(const io::Dataset& sensors, const std::string& file,
                                               Options* options);

/// The defaults with these on top, for commands that know no preset; what is overridden is noted on
/// stderr.
Options options_of(const io::Dataset& sensors, const std::string& file);

struct EstimatorArguments {
  std::string config;   ///< option file
  std::string preset;   ///< wins over the file's
  std::string backend;  ///< ekf or smoother; wins over both
};

/// Preset, then what is known of the sensors, then the values of the file, then the back-end of the
/// command line. What the file changes of what is known of the sensors is noted on stderr. Throws
/// std::runtime_error.
/// @param base what the preset is put on
Options make_options(const EstimatorArguments& arguments, const io::Dataset& sensors,
                     Options base = {});

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// The files of the rio program as Options of the library: the sensor files that `rio calibrate`
// writes and the option files that `rio options` prints. What a replay with --sensors, --config,
// --preset and --set flies with, to the last bit. Link rio::files (yaml-cpp, fmt); C++17.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rio/options.hpp"

namespace rio::files {

/// Where options come from; each overrides those before, and empty ones are left out.
struct Sources {
  std::string preset;             ///< name; else that of the option file
  std::filesystem::path sensors;  ///< folder with imu0/sensor.yaml, radar0/sensor.yaml, radar1/...
  std::filesystem::path config;   ///< option file: YAML, SI units or "2 deg"
  std::vector<std::string> set;   ///< "KEY=VALUE"
};

/// @param notes receives what a person should know: a missing sensor file or mounting, an unknown
/// key, what overrides a sensor file
/// @throws std::runtime_error "FILE:LINE: ..." for keys, types, units and ranges, "FILE: ..." for a
/// set of options that does not hold together
Options load(const Sources& sources, std::vector<std::string>* notes = nullptr);

/// An option file that loads to the same options, each with its unit and meaning. What only presets
/// set is that of the preset it names: what a program changed of it cannot be written.
std::string as_yaml(const Options& options);

}  // namespace rio::files

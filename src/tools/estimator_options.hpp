// SPDX-License-Identifier: BSD-3-Clause
// The options of a command's estimator; what overrides the sensor files is noted on stderr.
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "rio/io/flown_options.hpp"

namespace rio::tools {

using io::EstimatorArguments;
using io::OptionValues;

/// What a user should know of the inputs, on stderr.
inline void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
}

/// Without presets.
inline Options options_of(const io::Dataset& sensors, const OptionValues& values) {
  Options options;
  print_notes(io::tell_sensors_and_values(sensors, values, &options));
  return options;
}

inline Options make_options(const EstimatorArguments& arguments, const io::Dataset& sensors,
                            Options base = {}) {
  std::vector<std::string> notes;
  Options options = io::flown_options(arguments, sensors, std::move(base), &notes);
  print_notes(notes);
  return options;
}

}  // namespace rio::tools

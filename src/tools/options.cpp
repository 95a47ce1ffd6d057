// SPDX-License-Identifier: BSD-3-Clause
// `rio options`: all options with units, meaning and the values of a preset.
#include <fmt/format.h>

#include <string>

#include "commands.hpp"
#include "estimator_options.hpp"
#include "notes.hpp"
#include "recording.hpp"
#include "rio/io/options_yaml.hpp"

namespace rio::tools {

void print_options(const std::string& preset_name) {
  fmt::print("{}", io::option_file(preset_name));
}

void print_flown_options(const FlownOptionsArguments& arguments) {
  const OpenRecording recording = open_any(arguments.dataset, arguments.how);
  print_notes(recording.sensors.notes);
  const Options options = make_options(arguments.estimator, recording.sensors);
  if (options.radars() > 1) {
    fmt::print("# Of radar0; that of the others is in their sensor.yaml, with these defaults.\n");
  }
  fmt::print("{}", io::options_as_yaml(options));
}

void compare_presets() {
  fmt::print("{}", io::presets_as_table());
}

}  // namespace rio::tools

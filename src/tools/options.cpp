// SPDX-License-Identifier: BSD-3-Clause
// `rio options`: all options with units, meaning and the values of a preset.
#include <fmt/format.h>

#include <string>

#include "commands.hpp"
#include "estimator_options.hpp"
#include "recording.hpp"
#include "rio/io/options_yaml.hpp"

namespace rio::tools {

void print_options(const OptionsArguments& arguments) {
  if (arguments.compare) return fmt::print("{}", io::presets_as_table());
  const std::string& preset = arguments.estimator.preset;
  if (arguments.dataset.empty()) {
    return fmt::print("{}", io::option_file(preset.empty() ? "default" : preset));
  }
  const OpenRecording recording = open_any(arguments.dataset, arguments.how);
  print_notes(recording.sensors.notes);
  const Options options = make_options(arguments.estimator, recording.sensors);
  if (options.radars() > 1) {
    fmt::print("# Of radar0; that of the others is in their sensor.yaml, with these defaults.\n");
  }
  fmt::print("{}", io::options_as_yaml(options));
}

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
#include "estimator_options.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <utility>
#include <vector>

#include "rio/io/options_yaml.hpp"

namespace rio::tools {

namespace {

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) fmt::print(stderr, "note: {}\n", note);
}

}  // namespace

std::vector<std::string> tell_sensors_and_file(const io::Dataset& sensors, const std::string& file,
                                               Options* options) {
  std::vector<std::string> configured;
  io::apply_sensor_info(sensors, options, &configured);
  if (file.empty()) return {};
  const Options before = *options;
  io::load_option_values(file, options);
  io::apply_other_radars(sensors, options);
  std::vector<std::string> changed = io::changed_options(before, *options, configured);
  for (std::string& text : changed) text = file + " overrides the sensor files: " + text;
  return changed;
}

Options options_of(const io::Dataset& sensors, const std::string& file) {
  Options options;
  print_notes(tell_sensors_and_file(sensors, file, &options));
  return options;
}

Options make_options(const EstimatorArguments& arguments, const io::Dataset& sensors,
                     Options base) {
  std::string name = arguments.preset;
  if (name.empty() && !arguments.config.empty()) {
    name = io::preset_in_file(arguments.config).value_or("");
  }
  Options options = std::move(base);
  if (!name.empty() && !preset(name, &options)) {
    throw std::runtime_error("no such preset: \"" + name + "\"");
  }
  print_notes(tell_sensors_and_file(sensors, arguments.config, &options));
  if (!arguments.backend.empty()) {
    options.backend = arguments.backend == "smoother" ? BackEnd::kSmoother : BackEnd::kEkf;
  }
  return options;
}

}  // namespace rio::tools

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

std::vector<std::string> tell_sensors_and_file(const io::Dataset& sensors,
                                               const OptionValues& values, Options* options) {
  std::vector<std::string> configured;
  io::apply_sensor_info(sensors, options, &configured);
  const std::string& file = values.config;
  const Options before = *options;
  if (!file.empty()) io::load_option_values(file, options);
  std::vector<std::string> changed = io::changed_options(before, *options, configured);
  io::apply_settings(values.set, options);
  if (!file.empty() || !values.set.empty()) io::apply_other_radars(sensors, options);
  for (std::string& text : changed) text = file + " overrides the sensor files: " + text;
  return changed;
}

Options options_of(const io::Dataset& sensors, const OptionValues& values) {
  Options options;
  print_notes(tell_sensors_and_file(sensors, values, &options));
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
  print_notes(tell_sensors_and_file(sensors, arguments, &options));
  if (!arguments.backend.empty()) {
    options.backend = arguments.backend == "smoother" ? BackEnd::kSmoother : BackEnd::kEkf;
  }
  return options;
}

}  // namespace rio::tools

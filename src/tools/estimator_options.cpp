// SPDX-License-Identifier: BSD-3-Clause
#include "estimator_options.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <vector>

#include "rio/io/options_yaml.hpp"

namespace rio::tools {

Options make_options(const EstimatorArguments& arguments, const io::Dataset& sensors,
                     Options base) {
  std::string name = arguments.preset;
  if (name.empty() && !arguments.config.empty()) {
    name = io::preset_in_file(arguments.config).value_or("");
  }
  Options options = base;
  if (!name.empty() && !preset(name, &options)) {
    throw std::runtime_error("no such preset: \"" + name + "\"");
  }
  std::vector<std::string> told;
  io::apply_sensor_info(sensors, &options, &told);
  if (!arguments.config.empty()) {
    const Options before = options;
    io::load_option_values(arguments.config, &options);
    for (const std::string& changed : io::changed_options(before, options, told)) {
      fmt::print(stderr, "note: {} overrides the sensor files: {}\n", arguments.config, changed);
    }
  }
  if (!arguments.backend.empty()) {
    options.backend = arguments.backend == "smoother" ? BackEnd::kSmoother : BackEnd::kEkf;
  }
  return options;
}

}  // namespace rio::tools

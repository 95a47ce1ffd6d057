// SPDX-License-Identifier: BSD-3-Clause
#include "rio/files.hpp"

#include <stdexcept>

#include "rio/io/flown_options.hpp"
#include "rio/io/options_yaml.hpp"

namespace rio::files {

Options load(const Sources& sources, std::vector<std::string>* notes) {
  io::EstimatorArguments arguments;
  arguments.preset = sources.preset;
  arguments.config = sources.config.string();
  arguments.set = sources.set;
  io::Dataset sensors;
  if (!sources.sensors.empty()) sensors = io::read_sensor_info(sources.sensors);
  std::vector<std::string> told = sensors.notes;
  Options options = io::flown_options(arguments, sensors, {}, &told);
  std::string why;
  if (!options.validate(&why)) throw std::runtime_error(why);
  if (notes != nullptr) notes->insert(notes->end(), told.begin(), told.end());
  return options;
}

std::string as_yaml(const Options& options) {
  return io::options_as_yaml(options);
}

}  // namespace rio::files

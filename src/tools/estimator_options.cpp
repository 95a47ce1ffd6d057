// SPDX-License-Identifier: BSD-3-Clause
#include "estimator_options.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

#include "notes.hpp"
#include "rio/io/options_yaml.hpp"

namespace rio::tools {

namespace {

constexpr const char* kTexts = "options";  ///< name of EstimatorArguments::values in messages

}  // namespace

std::vector<std::string> tell_sensors_and_values(const io::Dataset& sensors,
                                                 const EstimatorArguments& arguments,
                                                 Options* options) {
  const std::string& file = arguments.config;
  std::vector<std::string> configured;
  io::apply_sensor_info(sensors, options, &configured);
  if (file.empty() && arguments.values.empty()) return {};
  const Options before = *options;
  if (!file.empty()) io::load_option_values(file, options);
  if (!arguments.values.empty()) io::parse_option_values(arguments.values, kTexts, options);
  io::apply_other_radars(sensors, options);
  std::vector<std::string> changed = io::changed_options(before, *options, configured);
  const std::string source = arguments.values.empty() ? file + " overrides" : "options override";
  for (std::string& text : changed) text = source + " the sensor files: " + text;
  return changed;
}

Options options_of(const io::Dataset& sensors, const std::string& file) {
  Options options;
  EstimatorArguments arguments;
  arguments.config = file;
  print_notes(tell_sensors_and_values(sensors, arguments, &options));
  return options;
}

Options make_options(const EstimatorArguments& arguments, const io::Dataset& sensors, Options base,
                     std::vector<std::string>* notes) {
  std::string name = arguments.preset;
  if (name.empty()) name = io::preset_in_texts(arguments.values, kTexts).value_or("");
  if (name.empty() && !arguments.config.empty()) {
    name = io::preset_in_file(arguments.config).value_or("");
  }
  Options options = std::move(base);
  if (!name.empty() && !preset(name, &options)) {
    throw std::runtime_error("no such preset: \"" + name + "\"");
  }
  const std::vector<std::string> changed = tell_sensors_and_values(sensors, arguments, &options);
  if (notes == nullptr) {
    print_notes(changed);
  } else {
    notes->insert(notes->end(), changed.begin(), changed.end());
  }
  if (!arguments.backend.empty()) {
    options.backend = arguments.backend == "smoother" ? BackEnd::kSmoother : BackEnd::kEkf;
  }
  return options;
}

}  // namespace rio::tools

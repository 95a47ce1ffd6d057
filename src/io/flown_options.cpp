// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/flown_options.hpp"

#include <utility>

#include "rio/io/csv.hpp"
#include "rio/io/options_yaml.hpp"

namespace rio::io {

namespace {

constexpr const char* kTexts = "options";  ///< name of OptionValues::texts in messages

}  // namespace

std::vector<std::string> tell_sensors_and_values(const Dataset& sensors, const OptionValues& values,
                                                 Options* options) {
  const std::string& file = values.config;
  std::vector<std::string> configured;
  apply_sensor_info(sensors, options, &configured);
  if (file.empty() && values.texts.empty() && values.set.empty()) return {};
  const Options before = *options;
  if (!file.empty()) parse_option_values({read_text(file)}, file, options);
  if (!values.texts.empty()) parse_option_values(values.texts, kTexts, options);
  std::vector<std::string> changed = changed_options(before, *options, configured);
  apply_settings(values.set, options);
  apply_other_radars(sensors, options);
  const std::string source = values.texts.empty() ? file + " overrides" : "options override";
  for (std::string& text : changed) text = source + " the sensor files: " + text;
  return changed;
}

Options flown_options(const EstimatorArguments& arguments, const Dataset& sensors, Options base,
                      std::vector<std::string>* notes) {
  std::string name = preset_in_settings(arguments.set).value_or(arguments.preset);
  if (name.empty()) name = preset_in_texts(arguments.texts, kTexts).value_or("");
  if (name.empty() && !arguments.config.empty()) {
    name = preset_in_texts({read_text(arguments.config)}, arguments.config).value_or("");
  }
  Options options = name.empty() ? std::move(base) : preset_named(name, std::move(base));
  const std::vector<std::string> changed = tell_sensors_and_values(sensors, arguments, &options);
  notes->insert(notes->end(), changed.begin(), changed.end());
  if (!arguments.backend.empty()) {
    options.backend = arguments.backend == "smoother" ? BackEnd::kSmoother : BackEnd::kEkf;
  }
  return options;
}

}  // namespace rio::io

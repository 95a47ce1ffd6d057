// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/options_yaml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "fields_yaml.hpp"
#include "rio/io/dataset.hpp"
#include "rio/option_fields.hpp"
#include "yaml.hpp"

namespace rio::io {

namespace {

constexpr const char* kPresetKey = "preset";
const std::string kUnits =
    "# All options. Numbers are in the unit shown; \"2 deg\", \"5 cm\" also work.\n";

/// The name of the preset, which there is.
std::optional<std::string> preset_of(const YamlFile& file) {
  const YAML::Node node = file.root[kPresetKey];
  if (!node.IsDefined()) return std::nullopt;
  Options scratch;
  if (!node.IsScalar() || !preset(node.Scalar(), &scratch)) {
    fail_at(file, node, "preset: no such preset: \"" + node.Scalar() + "\"");
  }
  return node.Scalar();
}

/// What only the presets set, and what earlier versions had.
std::vector<ClosedKey> closed_keys() {
  const char* constant = "is a constant";
  const char* merged = "is part of update.doppler_directions (exact, noisy, corrected)";
  const char* no_effect = "is gone: neither flights nor recordings showed an effect";
  std::vector<ClosedKey> keys = {
      {"calibration.elevation_bias_sigma",
       "is gone: calibration.rotation_sigma estimates a pitch of the mounting, and no flight can "
       "tell the two apart"},
      {"frontend.landmark_miss_tolerance",
       "is Options::frontend.landmark_timeout of the library [s]"},
      {"frontend.match_cells", constant},
      {"frontend.ransac_min_inliers", constant},
      {"frontend.ransac_min_share", no_effect},
      {"frontend.ransac_success", constant},
      {"frontend.velocity_recovery", "is Options::checks of the library, one for each check"},
      {"start.max_accel_std", constant},
      {"start.max_gyro_std", constant},
      {"update.direction_correction", merged},
      {"update.direction_noise", merged},
      {"update.direction_reliability", merged},
      {"update.extrinsic_rotation_sigma", "is calibration.rotation_sigma"},
      {"update.extrinsic_translation_sigma", "is calibration.translation_sigma"},
      {"update.trail_noise", no_effect},
  };
  const Options options;
  visit_preset_fields(options, [&keys](const FieldInfo& info, const auto&) {
    keys.push_back({info.key, "belongs to the preset, it is no option of a file"});
  });
  visit_library_fields(options, [&keys](const FieldInfo& info, const auto&) {
    keys.push_back({info.key, "is set in the library only (rio/options.hpp)"});
  });
  return keys;
}

void apply_values(const YamlFile& file, Options* options) {
  read_fields(file, kPresetKey, options, closed_keys());
}

/// Changes the options if what results is coherent.
/// @param name of the file, for the message
template <class Apply>
void change(const std::string& name, Options* options, const Apply& apply) {
  Options changed = *options;
  apply(&changed);
  std::string why;
  if (!changed.validate(&why)) throw std::runtime_error(name + ": " + why);
  *options = changed;
}

/// KEY=VALUE as a file.
YamlFile parse_setting(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw std::runtime_error("\"" + setting + "\": is not KEY=VALUE");
  }
  YamlFile file =
      parse_yaml(setting.substr(0, equals) + ": " + setting.substr(equals + 1), setting);
  file.has_lines = false;
  return file;
}

/// The keys that sensor files or the preset set.
std::vector<std::string> not_of_the_user() {
  std::vector<std::string> keys = sensor_option_keys();
  const Options options;
  visit_fields(options, [&keys](const FieldInfo& info, const auto&) {
    if (info.layer == Layer::kAlgorithm) keys.emplace_back(info.key);
  });
  return keys;
}

/// Value and meaning of every option, those of the presets included.
struct OptionText {
  std::string key;
  std::string value;
  std::string meaning;
};
std::vector<OptionText> option_texts(const Options& options) {
  std::vector<OptionText> texts;
  const auto add = [&texts](const FieldInfo& info, const auto& value) {
    const std::string unit = *info.unit == '\0' ? "" : fmt::format(" [{}]", info.unit);
    texts.push_back({info.key, PrintField{}(value), info.doc + unit});
  };
  visit_fields(options, add);
  visit_preset_fields(options, add);
  return texts;
}

}  // namespace

Options preset_named(const std::string& name, Options base) {
  if (preset(name, &base)) return base;
  throw std::runtime_error(
      fmt::format("no such preset: \"{}\"; there are {}", name, fmt::join(kPresets, ", ")));
}

void apply_settings(const std::vector<std::string>& settings, Options* options) {
  change("settings", options, [&settings](Options* changed) {
    for (const std::string& setting : settings) apply_values(parse_setting(setting), changed);
  });
}

void parse_options(const std::string& yaml, const std::string& name, Options* options) {
  const YamlFile file = parse_yaml(yaml, name);
  change(name, options, [&file](Options* changed) {
    if (const auto base = preset_of(file)) (void)preset(*base, changed);
    apply_values(file, changed);
  });
}

void parse_option_values(const std::vector<std::string>& yaml, const std::string& name,
                         Options* options) {
  change(name, options, [&](Options* changed) {
    for (const std::string& text : yaml) apply_values(parse_yaml(text, name), changed);
  });
}

std::optional<std::string> preset_in_texts(const std::vector<std::string>& yaml,
                                           const std::string& name) {
  std::optional<std::string> last;
  for (const std::string& text : yaml) {
    if (const auto found = preset_of(parse_yaml(text, name))) last = found;
  }
  return last;
}

std::optional<std::string> preset_in_settings(const std::vector<std::string>& settings) {
  std::optional<std::string> last;
  for (const std::string& setting : settings) {
    if (const auto found = preset_of(parse_setting(setting))) last = found;
  }
  return last;
}

std::string preset_of(const Options& options) {
  std::size_t shown = 0;  // by fields_text(); the others belong to the preset alone
  visit_fields(options, [&shown](const FieldInfo&, const auto&) { ++shown; });
  const std::vector<OptionText> texts = option_texts(options);
  std::string name;
  std::size_t fewest = texts.size();
  for (const char* candidate : kPresets) {
    const std::vector<OptionText> its = option_texts(preset_named(candidate));
    std::size_t differ = 0;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (texts[i].value != its[i].value) differ += i < shown ? 1 : texts.size();
    }
    if (differ >= fewest) continue;
    fewest = differ;
    name = candidate;
  }
  return name;
}

std::string options_as_yaml(const Options& options) {
  const std::string name = preset_of(options);
  const bool said = !name.empty() && name != kPresets[0];
  return kUnits + (said ? fmt::format("{}: {}\n", kPresetKey, name) : "") + fields_text(options);
}

std::string option_file(const std::string& preset_name) {
  return kUnits +
         "# What is commented out comes from the sensor.yaml of a recording (imu, radar) or "
         "belongs "
         "to the\n# preset, the algorithm; said here, it wins over either.\n" +
         fmt::format("{}: {}\n", kPresetKey, preset_name) +
         fields_text(preset_named(preset_name), not_of_the_user());
}

std::vector<std::string> changed_options(const Options& before, const Options& after,
                                         const std::vector<std::string>& keys) {
  const std::vector<OptionText> old = option_texts(before);
  const std::vector<OptionText> now = option_texts(after);
  std::vector<std::string> changed;
  for (std::size_t i = 0; i < old.size(); ++i) {
    const bool asked = std::find(keys.begin(), keys.end(), old[i].key) != keys.end();
    if (!asked || old[i].value == now[i].value) continue;
    changed.push_back(fmt::format("{} = {} ({})", old[i].key, now[i].value, old[i].value));
  }
  return changed;
}

std::string presets_as_table() {
  std::vector<std::vector<OptionText>> presets;
  std::string text = "| option |";
  std::string rule = "| --- |";
  for (const char* name : kPresets) {
    presets.push_back(option_texts(preset_named(name)));
    text += fmt::format(" {} |", name);
    rule += " --- |";
  }
  text += " meaning |\n" + rule + " --- |\n";
  for (std::size_t i = 0; i < presets[0].size(); ++i) {
    const auto same = [&](const std::vector<OptionText>& other) {
      return other[i].value == presets[0][i].value;
    };
    if (std::all_of(presets.begin(), presets.end(), same)) continue;
    text += fmt::format("| `{}` |", presets[0][i].key);
    for (const auto& values : presets) text += fmt::format(" {} |", values[i].value);
    text += fmt::format(" {} |\n", presets[0][i].meaning);
  }
  return text;
}

}  // namespace rio::io

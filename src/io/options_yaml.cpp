// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/options_yaml.hpp"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "rio/io/csv.hpp"
#include "rio/option_fields.hpp"
#include "unit_quaternion.hpp"
#include "yaml.hpp"

namespace rio::io {

namespace {

constexpr const char* kPresetKey = "preset";
constexpr std::string_view kTrailNoiseNames[] = {"independent", "correlated"};

std::vector<std::string> all_keys() {
  std::vector<std::string> keys = {kPresetKey};
  const Options options;
  visit_fields(options,
               [&keys](const FieldInfo& info, const auto&) { keys.emplace_back(info.key); });
  return keys;
}

/// Reads one YAML value into a field of any type.
struct Assign {
  const YamlFile& file;
  const YAML::Node& node;
  const FieldInfo& info;

  void operator()(double& field) const { field = yaml_number(file, node, info.key, info.unit); }

  void operator()(int& field) const {
    const std::string& text = node.Scalar();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), field);
    if (!node.IsScalar() || error != std::errc{} || end != text.data() + text.size()) {
      wrong("a whole number is expected");
    }
  }

  void operator()(bool& field) const {
    const std::string& text = node.Scalar();
    if (text != "true" && text != "false") wrong("true or false is expected");
    field = text == "true";
  }

  void operator()(TrailNoise& field) const {
    for (const TrailNoise noise : {TrailNoise::kIndependent, TrailNoise::kCorrelated}) {
      if (node.Scalar() != kTrailNoiseNames[static_cast<std::size_t>(noise)]) continue;
      field = noise;
      return;
    }
    wrong("independent or correlated is expected");
  }

  void operator()(Vector3d& field) const {
    const std::vector<double> v = yaml_numbers(file, node, info.key, info.unit, 3);
    field = Vector3d(v[0], v[1], v[2]);
  }

  void operator()(Quaternion& field) const {
    const std::vector<double> v = yaml_numbers(file, node, info.key, info.unit, 4);
    const auto q = unit_quaternion(v[0], v[1], v[2], v[3]);
    if (!q) wrong("not a unit quaternion");
    field = *q;
  }

  [[noreturn]] void wrong(const char* what) const {
    fail_at(file, node, std::string(info.key) + ": " + what);
  }
};

/// Sets the field named `key`; false if there is none.
bool set_field(const YamlFile& file, const YAML::Node& node, const std::string& key,
               Options* options) {
  bool found = false;
  visit_fields(*options, [&](const FieldInfo& info, auto& field) {
    if (key != info.key) return;
    found = true;
    Assign{file, node, info}(field);
    const std::string error = field_error(info, field);
    if (!error.empty()) fail_at(file, node, error);
  });
  return found;
}

bool is_section(const std::string& key, const std::vector<std::string>& keys) {
  for (const std::string& candidate : keys) {
    if (candidate.starts_with(key + ".")) return true;
  }
  return false;
}

void set_fields(const YamlFile& file, const YAML::Node& map, const std::string& prefix,
                const std::vector<std::string>& keys, Options* options) {
  for (const auto& entry : map) {
    const std::string key = prefix + entry.first.Scalar();
    const YAML::Node& value = entry.second;
    if (key == kPresetKey) continue;
    if (is_section(key, keys)) {
      if (!value.IsMap() && !value.IsNull()) fail_at(file, value, key + ": a map is expected");
      set_fields(file, value, key + ".", keys, options);
    } else if (!set_field(file, value, key, options)) {
      fail_at(file, entry.first, "unknown key \"" + key + "\"" + did_you_mean(key, keys));
    }
  }
}

YAML::Node preset_node(const YamlFile& file) {
  for (const auto& entry : file.root) {
    if (entry.first.Scalar() == kPresetKey) return entry.second;
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

void apply_preset(const YamlFile& file, Options* options) {
  const YAML::Node node = preset_node(file);
  if (!node.IsDefined()) return;
  if (!node.IsScalar() || !preset(node.Scalar(), options)) {
    fail_at(file, node, "preset: no such preset: \"" + node.Scalar() + "\"");
  }
}

void apply_values(const YamlFile& file, Options* options) {
  set_fields(file, file.root, "", all_keys(), options);
  std::string why;
  if (!options->validate(&why)) throw std::runtime_error(file.name + ": " + why);
}

void apply_file(const YamlFile& file, Options* options) {
  Options changed = *options;
  apply_preset(file, &changed);
  apply_values(file, &changed);
  *options = changed;
}

/// The YAML text of one field.
struct Print {
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(int value) const { return fmt::format("{}", value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(TrailNoise value) const {
    return std::string(kTrailNoiseNames[static_cast<std::size_t>(value)]);
  }
  std::string operator()(const Vector3d& v) const {
    return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
  }
  std::string operator()(const Quaternion& q) const {
    return fmt::format("[{}, {}, {}, {}]", q.w(), q.x(), q.y(), q.z());
  }
};

/// Opens the sections in which `key` lies and `previous` does not; returns the indented last part.
std::string open_sections(std::string_view key, std::string_view previous, std::string* text) {
  std::size_t begin = 0;
  std::string indent;
  for (std::size_t dot = key.find('.'); dot != std::string_view::npos; dot = key.find('.', begin)) {
    if (!previous.starts_with(key.substr(0, dot + 1))) {
      *text += fmt::format("{}{}:\n", indent, key.substr(begin, dot - begin));
    }
    begin = dot + 1;
    indent += "  ";
  }
  return indent + std::string(key.substr(begin));
}

}  // namespace

void load_options(const std::filesystem::path& path, Options* options) {
  apply_file(load_yaml(path), options);
}

void load_option_values(const std::filesystem::path& path, Options* options) {
  Options changed = *options;
  apply_values(load_yaml(path), &changed);
  *options = changed;
}

std::optional<std::string> preset_in_file(const std::filesystem::path& path) {
  const YamlFile file = load_yaml(path);
  Options scratch;
  apply_preset(file, &scratch);  // the name is checked where the line is known
  const YAML::Node node = preset_node(file);
  if (!node.IsDefined()) return std::nullopt;
  return node.Scalar();
}

void parse_options(const std::string& yaml, const std::string& name, Options* options) {
  apply_file(parse_yaml(yaml, name), options);
}

std::string options_as_yaml(const Options& options) {
  std::string text =
      "# All options. Numbers are in the unit shown; \"2 deg\", \"5 cm\" also work.\n";
  std::string_view previous;
  visit_fields(options, [&](const FieldInfo& info, const auto& field) {
    const std::string label = open_sections(info.key, previous, &text);
    const std::string unit = *info.unit == '\0' ? "" : fmt::format("[{}] ", info.unit);
    text += fmt::format("{}: {}  # {}{}\n", label, Print{}(field), unit, info.doc);
    previous = info.key;
  });
  return text;
}

}  // namespace rio::io

// SPDX-License-Identifier: BSD-3-Clause
// Structs with a table of fields (`visit_fields(object, visitor)`, rio/core/field.hpp) from and to
// YAML nested by the dots of the keys; private to rio_io because it exposes yaml-cpp. A top-level
// base key of a file may name the object that its values modify: a preset for options, a scenario
// for scenarios.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "decimal.hpp"
#include "rio/core/field.hpp"
#include "rio/option_fields.hpp"
#include "yaml.hpp"

namespace rio::io {

/// Reads one YAML value into a field of any type; throws "FILE:LINE: KEY: ..." if it does not fit.
struct ReadField {
  const YamlFile& file;
  const YAML::Node& node;
  const FieldInfo& info;

  void operator()(double& field) const { field = yaml_number(file, node, info.key, info.unit); }
  void operator()(int& field) const { whole_number(field); }
  void operator()(std::uint64_t& field) const { whole_number(field); }

  void operator()(bool& field) const {
    const std::string& text = node.Scalar();
    if (text != "true" && text != "false") wrong("true or false is expected");
    field = text == "true";
  }

  void operator()(std::string& field) const {
    if (!node.IsScalar()) wrong("a text is expected");
    field = node.Scalar();
  }

  template <class Enum>
  requires std::is_enum_v<Enum>
  void operator()(Enum& field) const {
    const auto names = names_of(field);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (node.Scalar() != names[i]) continue;
      field = static_cast<Enum>(i);
      return;
    }
    wrong(fmt::format("{} is expected", fmt::join(names, " or ")).c_str());
  }

  void operator()(Vector3d& field) const { field = yaml_vector(file, node, info.key, info.unit); }

  void operator()(Quaternion& field) const { field = yaml_quaternion(file, node, info.key); }

 private:
  template <class Integer>
  void whole_number(Integer& field) const {
    const auto value = plain_number_of<Integer>(node.Scalar());
    if (!value) wrong("a whole number is expected");
    field = *value;
  }

  [[noreturn]] void wrong(const char* what) const {
    fail_at(file, node, std::string(info.key) + ": " + what);
  }
};

/// The YAML text of one field.
struct PrintField {
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(int value) const { return fmt::format("{}", value); }
  std::string operator()(std::uint64_t value) const { return fmt::format("{}", value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(const std::string& value) const {
    YAML::Emitter text;
    text << YAML::DoubleQuoted << value;
    return text.c_str();
  }
  template <class Enum>
  requires std::is_enum_v<Enum> std::string operator()(Enum value) const {
    return std::string(names_of(value)[static_cast<std::size_t>(value)]);
  }
  std::string operator()(const Vector3d& v) const {
    return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
  }
  std::string operator()(const Quaternion& q) const {
    return fmt::format("[{}, {}, {}, {}]", q.w(), q.x(), q.y(), q.z());
  }
};

/// A key that is not for files, and why: "KEY WHY" is the error.
struct ClosedKey {
  std::string key;
  std::string why;
};

namespace fields_yaml_detail {

inline bool is_section(const std::string& key, const std::vector<std::string>& keys) {
  for (const std::string& candidate : keys) {
    if (candidate.starts_with(key + ".")) return true;
  }
  return false;
}

inline std::vector<std::string> sections_of(const std::vector<std::string>& keys) {
  std::set<std::string> sections;
  for (const std::string& key : keys) {
    for (std::size_t dot = 0; (dot = key.find('.', dot)) != std::string::npos; ++dot) {
      sections.insert(key.substr(0, dot));
    }
  }
  return {sections.begin(), sections.end()};
}

/// Opens the sections of `key` that `previous` does not have; returns the indented last part.
inline std::string open_sections(std::string_view key, std::string_view previous,
                                 std::string* text) {
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

/// Sets the field `key` and checks its range; false if there is no such field.
template <class Object>
bool set_field(const YamlFile& file, const std::string& key, const YAML::Node& node,
               Object* object) {
  bool found = false;
  visit_fields(*object, [&](const FieldInfo& info, auto& field) {
    if (key != info.key) return;
    found = true;
    ReadField{file, node, info}(field);
    const std::string error = field_error(info, field);
    if (!error.empty()) fail_at(file, node, error);
  });
  return found;
}

/// Reads a section with the keys below `prefix`.
template <class Object>
void read_section(const YamlFile& file, const YAML::Node& map, const std::string& prefix,
                  const std::vector<std::string>& keys, const std::vector<ClosedKey>& closed,
                  Object* object) {
  for (const auto& entry : map) {
    const std::string key = prefix + entry.first.Scalar();
    const YAML::Node& value = entry.second;
    const auto why = std::find_if(closed.begin(), closed.end(),
                                  [&key](const ClosedKey& each) { return each.key == key; });
    if (key == keys.front()) continue;  // the base
    const bool of_closed = std::any_of(closed.begin(), closed.end(), [&key](const ClosedKey& each) {
      return std::string_view(each.key).starts_with(key + ".");
    });
    if (is_section(key, keys) || (of_closed && value.IsMap())) {
      if (!value.IsMap() && !value.IsNull()) fail_at(file, value, key + ": a map is expected");
      read_section(file, value, key + ".", keys, closed, object);
    } else if (why != closed.end()) {
      fail_at(file, entry.first, key + " " + why->why);
    } else if (!set_field(file, key, value, object)) {
      fail_at(file, entry.first,
              "unknown key \"" + key + "\"" +
                  did_you_mean(key, value.IsMap() ? sections_of(keys) : keys));
    }
  }
}

}  // namespace fields_yaml_detail

/// Sets every field in the file; `base_key` is skipped. Unknown keys, wrong types, units and ranges
/// throw std::runtime_error "FILE:LINE: ...", after earlier fields have been set.
template <class Object>
void read_fields(const YamlFile& file, const std::string& base_key, Object* object,
                 const std::vector<ClosedKey>& closed = {}) {
  std::vector<std::string> keys = {base_key};
  visit_fields(*object,
               [&keys](const FieldInfo& info, const auto&) { keys.emplace_back(info.key); });
  fields_yaml_detail::read_section(file, file.root, "", keys, closed, object);
}

/// Every field with its unit and meaning as a comment; reads back to the same values.
/// @param unsaid keys whose lines are commented out
template <class Object>
std::string fields_text(const Object& object, const std::vector<std::string>& unsaid = {}) {
  std::string text;
  std::string_view previous;
  visit_fields(object, [&](const FieldInfo& info, const auto& field) {
    std::string label = fields_yaml_detail::open_sections(info.key, previous, &text);
    if (std::find(unsaid.begin(), unsaid.end(), info.key) != unsaid.end()) {
      label.insert(label.find_first_not_of(' '), "# ");
    }
    const std::string unit = *info.unit == '\0' ? "" : fmt::format("[{}] ", info.unit);
    text += fmt::format("{}: {}  # {}{}\n", label, PrintField{}(field), unit, info.doc);
    previous = info.key;
  });
  return text;
}

}  // namespace rio::io

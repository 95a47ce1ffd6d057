// SPDX-License-Identifier: BSD-3-Clause
// YAML with file and line in errors; private to rio_io because it exposes yaml-cpp.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "rio/types.hpp"

namespace rio::io {

/// A parsed file of one document without duplicate keys.
struct YamlFile {
  std::string name;  ///< for messages
  YAML::Node root;   ///< a map, or null when the file holds comments only
  bool has_lines = true;
};

YamlFile parse_yaml(const std::string& text, const std::string& name);
YamlFile load_yaml(const std::filesystem::path& path);

/// Throws "FILE:LINE: what", or "FILE: what" if it has no lines.
[[noreturn]] void fail_at(const YamlFile& file, const YAML::Node& node, const std::string& what);

/// A number with or without a unit; `key` is for the message.
double yaml_number(const YamlFile& file, const YAML::Node& node, const std::string& key,
                   const char* si_unit);
/// A list of exactly `count` numbers.
std::vector<double> yaml_numbers(const YamlFile& file, const YAML::Node& node,
                                 const std::string& key, const char* si_unit, std::size_t count);
/// Three numbers.
Vector3d yaml_vector(const YamlFile& file, const YAML::Node& node, const std::string& key,
                     const char* si_unit);
/// w, x, y, z of a unit quaternion.
Quaternion yaml_quaternion(const YamlFile& file, const YAML::Node& node, const std::string& key);

/// `, did you mean "x"?` for the candidate nearest to `key`, or empty when none is near. A key in
/// another section counts as near when its last part matches.
std::string did_you_mean(const std::string& key, const std::vector<std::string>& candidates);

}  // namespace rio::io

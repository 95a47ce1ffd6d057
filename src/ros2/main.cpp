// SPDX-License-Identifier: BSD-3-Clause
// `rio-ros2`: the estimator as a node of ROS 2, without ROS: it speaks DDS.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/fields_yaml.hpp"
#include "ros2/node.hpp"
#include "stop_signal.hpp"
#include "version.hpp"

namespace rio::ros2 {

namespace {

constexpr const char* kNode = "rio";
constexpr const char* kSection = "ros__parameters";

/// The values that are of this node. Those of all nodes may be of others, which is noted.
/// @param shared they are of all nodes
YAML::Node own_values(const io::YamlFile& all, const YAML::Node& values, bool shared,
                      const Parameters& parameters) {
  std::set<std::string_view> keys;
  visit_fields(parameters, [&](const FieldInfo& field, const auto&) { keys.insert(field.key); });
  YAML::Node own(YAML::NodeType::Map);
  for (const auto& entry : values) {
    const std::string key = entry.first.Scalar();
    if (key == "qos_overrides") continue;  // of rclcpp
    if (shared && keys.count(key) == 0) {
      fmt::print(stderr, "rio-ros2: {}:{}: \"{}\" is no parameter of this node\n", all.name,
                 entry.first.Mark().line + 1, key);
      continue;
    }
    if (key == "radar_topics" && entry.second.IsSequence()) {
      own[key] = fmt::format("{}", fmt::join(entry.second.as<std::vector<std::string>>(), ","));
    } else {
      own[entry.first] = entry.second;
    }
  }
  return own;
}

/// The values of the node `rio` (or /rio, NAMESPACE/rio, NAMESPACE: rio, /**) in a part of a
/// parameter file.
/// @param called its name, if not `rio`
/// @return whether there are any
bool read_nodes(const io::YamlFile& all, const YAML::Node& part, const std::string& called,
                Parameters* parameters) {
  bool found = false;
  for (const auto& node : part) {
    const std::string name = node.first.Scalar().substr(node.first.Scalar().rfind('/') + 1);
    const bool shared = name == "**" || name == "*";
    const YAML::Node values = node.second.IsMap() ? node.second[kSection] : YAML::Node();
    if (!values.IsDefined() || !values.IsMap()) {
      if (name == called) io::fail_at(all, node.second, std::string("no ") + kSection);
      found |= node.second.IsMap() && read_nodes(all, node.second, called, parameters);
    } else if (shared || name == called) {
      io::read_fields({all.name, own_values(all, values, shared, *parameters)}, "", parameters);
      found = true;
    }
  }
  return found;
}

/// @throws std::runtime_error "FILE:LINE: ..." for unknown parameters, and if the node is missing
void load_parameters(const std::string& file, const std::string& called, Parameters* parameters) {
  const io::YamlFile all = io::load_yaml(file);
  if (!read_nodes(all, all.root, called, parameters)) {
    throw std::runtime_error(file + ": no parameters of a node /" + called);
  }
}

/// The parts of "NAME:=VALUE".
std::pair<std::string, std::string> parts_of(const std::string& assignment) {
  const std::size_t at = assignment.find(":=");
  if (at == std::string::npos) {
    throw std::runtime_error("\"" + assignment + "\": NAME:=VALUE is expected");
  }
  return {assignment.substr(0, at), assignment.substr(at + 2)};
}

/// As `ros2 run ... --ros-args -p`.
void set_parameter(const std::string& assignment, Parameters* parameters) {
  const auto [name, value] = parts_of(assignment);
  io::read_fields(io::parse_yaml(name + ": " + value, assignment), "", parameters);
}

/// Another topic, as `ros2 run ... --ros-args -r`. Their names are absolute: no namespace counts.
void remap(const std::string& rule, Parameters* parameters) {
  const auto [from, to] = parts_of(rule);
  bool found = from == "__node" || from == "__ns";
  visit_fields(*parameters, [&, &was = from, &is = to](const FieldInfo& field, auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>) {
      if (value != was || std::string_view(field.key).find("topic") == std::string::npos) return;
      value = is;
      found = true;
    }
  });
  if (!found) throw std::runtime_error("-r " + rule + ": this node has no topic " + from);
}

/// Every parameter with its meaning, as a parameter file.
std::string parameter_file(const Parameters& parameters) {
  std::istringstream lines(io::fields_text(parameters));
  std::string text = std::string("/") + kNode + ":\n  " + kSection + ":\n";
  for (std::string line; std::getline(lines, line);) text += "    " + line + "\n";
  return text;
}

/// As ROS 2 has it: ROS_DOMAIN_ID, else 0.
unsigned domain_id() {
  const char* given = std::getenv("ROS_DOMAIN_ID");
  const std::string_view text = given == nullptr || *given == '\0' ? "0" : given;
  unsigned id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error == std::errc() && end == text.data() + text.size() && id <= 232) return id;
  throw std::runtime_error("ROS_DOMAIN_ID: a number from 0 to 232 is expected");
}

int run(int argc, char** argv) {
  CLI::App app("Radar-inertial odometry as a node of ROS 2: IMU and radar topics in, odometry out",
               "rio-ros2");
  app.set_version_flag("--version", tools::version_text());
  std::vector<std::string> files;
  std::vector<std::string> values;
  std::vector<std::string> rules;
  std::string level;
  bool print = false;
  bool ros = false;
  app.add_flag("--ros-args", ros, "as ROS 2 starts nodes; what follows is the same without it");
  app.add_option("--params-file", files, "parameter file of ROS 2")->allow_extra_args(false);
  app.add_option("-p", values, "one parameter, as odometry_rate:=50")->allow_extra_args(false);
  app.add_option("-r,--remap", rules,
                 "another topic, as /imu/data:=/mavros/imu/data_raw; __node:=NAME")
      ->allow_extra_args(false);
  app.add_option("--log-level", level, "as ROS 2 starts nodes; without effect");
  app.add_flag("--print-params", print, "print a parameter file with every value, and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  Parameters parameters;
  std::string name = kNode;
  for (const std::string& rule : rules) {
    if (const auto [from, to] = parts_of(rule); from == "__node") name = to;
  }
  for (const std::string& file : files) load_parameters(file, name, &parameters);
  for (const std::string& value : values) set_parameter(value, &parameters);
  for (const std::string& rule : rules) remap(rule, &parameters);
  if (print) {
    fmt::print("{}", parameter_file(parameters));
    return 0;
  }
  tools::catch_stop_signals();
  Node node(parameters, domain_id());
  while (tools::stop_requested == 0) node.step();
  fmt::print(stderr, "{}", node.summary());
  return 0;
}

}  // namespace

}  // namespace rio::ros2

int main(int argc, char** argv) {
  try {
    return rio::ros2::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rio-ros2: %s\n", error.what());
    return 1;
  }
}

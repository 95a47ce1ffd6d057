// SPDX-License-Identifier: BSD-3-Clause
#include "ros2/parameters.hpp"

#include <sstream>
#include <stdexcept>

#include "io/fields_yaml.hpp"

namespace rio::ros2 {

namespace {

constexpr const char* kNode = "rio";
constexpr const char* kSection = "ros__parameters";

bool is_this_node(const std::string& name) {
  const std::string last = name.substr(name.rfind('/') + 1);
  return last == kNode || last == "**" || last == "*";
}

}  // namespace

void load_parameters(const std::string& file, Parameters* parameters) {
  const io::YamlFile all = io::load_yaml(file);
  bool found = false;
  for (const auto& node : all.root) {
    if (!is_this_node(node.first.Scalar())) continue;
    const YAML::Node values = node.second[kSection];
    if (!values.IsDefined()) io::fail_at(all, node.second, std::string("no ") + kSection);
    io::read_fields({all.name, values}, "", parameters);
    found = true;
  }
  if (!found) throw std::runtime_error(file + ": no parameters of a node /" + kNode);
}

void set_parameter(const std::string& assignment, Parameters* parameters) {
  const std::size_t at = assignment.find(":=");
  if (at == std::string::npos) {
    throw std::runtime_error("\"" + assignment + "\": NAME:=VALUE is expected");
  }
  const std::string yaml = assignment.substr(0, at) + ": " + assignment.substr(at + 2);
  io::read_fields(io::parse_yaml(yaml, assignment), "", parameters);
}

std::string parameter_file(const Parameters& parameters) {
  std::istringstream lines(io::fields_text(parameters));
  std::string text = std::string("/") + kNode + ":\n  " + kSection + ":\n";
  for (std::string line; std::getline(lines, line);) text += "    " + line + "\n";
  return text;
}

}  // namespace rio::ros2

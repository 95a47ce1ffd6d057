// SPDX-License-Identifier: BSD-3-Clause
// `rio-ros2`: the estimator as a node of ROS 2, without ROS: it speaks DDS.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "ros2/node.hpp"
#include "stop_signal.hpp"
#include "version.hpp"

namespace {

/// As ROS 2 has it: ROS_DOMAIN_ID, else 0.
unsigned domain_id() {
  const char* text = std::getenv("ROS_DOMAIN_ID");
  return text == nullptr || *text == '\0' ? 0 : static_cast<unsigned>(std::stoul(text));
}

int run(int argc, char** argv) {
  CLI::App app("Radar-inertial odometry as a node of ROS 2: IMU and radar topics in, odometry out",
               "rio-ros2");
  app.set_version_flag("--version", rio::tools::version_text());
  std::vector<std::string> files;
  std::vector<std::string> values;
  bool print = false;
  bool ros = false;
  app.add_flag("--ros-args", ros, "as ROS 2 starts nodes; what follows is the same without it");
  app.add_option("--params-file", files, "parameter file of ROS 2")->allow_extra_args(false);
  app.add_option("-p", values, "one parameter, as odometry_rate:=50")->allow_extra_args(false);
  app.add_flag("--print-params", print, "print a parameter file with every value, and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  rio::ros2::Parameters parameters;
  for (const std::string& file : files) load_parameters(file, &parameters);
  for (const std::string& value : values) set_parameter(value, &parameters);
  if (print) {
    fmt::print("{}", parameter_file(parameters));
    return 0;
  }
  rio::tools::catch_stop_signals();
  rio::ros2::Node node(parameters, domain_id());
  while (rio::tools::stop_requested == 0) node.step();
  fmt::print(stderr, "{}", node.summary());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rio-ros2: %s\n", error.what());
    return 1;
  }
}

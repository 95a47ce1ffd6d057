// SPDX-License-Identifier: BSD-3-Clause
// `rio options`: all options with units, meaning and the values of a preset.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <stdexcept>
#include <string>

#include "commands.hpp"
#include "rio/io/options_yaml.hpp"

namespace rio::tools {

namespace {

void print_options(const std::string& name) {
  Options options;
  if (!preset(name, &options)) throw std::runtime_error("no such preset: \"" + name + "\"");
  fmt::print("{}", io::options_as_yaml(options));
}

void compare_presets() {
  fmt::print("{}", io::presets_as_table());
}

}  // namespace

void add_options_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("options", "Print every option as a file to start from");
  auto name = std::make_shared<std::string>("default");
  command
      ->add_option("--preset", *name,
                   "default, published-ekf, published-smoother or published-uncertainty")
      ->capture_default_str();
  auto compare = std::make_shared<bool>(false);
  command->add_flag("--compare", *compare, "the options in which the presets differ, as a table");
  command->callback([name, compare] { *compare ? compare_presets() : print_options(*name); });
}

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// `rio options`: all options with units, meaning and the values of a preset.
#include <fmt/format.h>

#include <string>

#include "commands.hpp"
#include "rio/io/options_yaml.hpp"

namespace rio::tools {

void print_options(const std::string& preset_name) {
  fmt::print("{}", io::option_file(preset_name));
}

void compare_presets() {
  fmt::print("{}", io::presets_as_table());
}

}  // namespace rio::tools

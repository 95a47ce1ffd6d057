// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"

#include <cmath>
#include <string>

namespace rio::tools {

void refuse_nan(CLI::App* app) {
  const CLI::Validator is_number(
      [](std::string& text) {
        double value = 0.0;
        const bool nan = CLI::detail::lexical_cast(text, value) && std::isnan(value);
        return nan ? text + " is not a number" : std::string();
      },
      "");
  for (CLI::Option* option : app->get_options()) {
    if (option->get_type_name().rfind("FLOAT", 0) == 0) option->check(is_number);
  }
  for (CLI::App* command : app->get_subcommands({})) refuse_nan(command);
}

}  // namespace rio::tools

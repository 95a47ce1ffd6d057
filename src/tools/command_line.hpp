// SPDX-License-Identifier: BSD-3-Clause
// The command line of every command of `rio`, each added to the program by a function.
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

#include "estimator_options.hpp"

namespace rio::tools {

struct ViewArguments;

/// Makes options that take a number refuse nan, for which every range has room.
inline void refuse_nan(CLI::App* app) {
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

/// Common options of every command that runs the estimator.
void add_estimator_options(CLI::App* command, EstimatorArguments* estimator);

/// Report, log and viewers, of every command that runs the estimator over time.
void add_view_options(CLI::App* command, ViewArguments* view, const std::string& group);

void add_info_command(CLI::App& app);
void add_convert_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_replay_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_fit_noise_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_options_command(CLI::App& app);

void add_live_command(CLI::App& app);
void add_ti_config_command(CLI::App& app);
void add_simulate_command(CLI::App& app);
void add_bench_command(CLI::App& app);

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program. Exit codes: 0 success, 1 the command failed, 2 wrong command line, 3 the
// estimate is lost, or the recording or configuration is wrong.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "command_line.hpp"
#include "commands.hpp"
#include "version.hpp"

namespace rio::tools {

namespace {

int run(int argc, char** argv) {
  CLI::App app("Radar-inertial odometry: replay, simulate, evaluate and compare", "rio");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  for (const auto add :
       {add_info_command, add_convert_command, add_check_command, add_ti_config_command,
        add_replay_command, add_live_command, add_bench_command, add_simulate_command,
        add_scenarios_command, add_evaluate_command, add_compare_command, add_experiment_command,
        add_plot_command, add_fit_noise_command, add_calibrate_command, add_options_command,
        add_describe_command}) {
    add(app);
  }
  refuse_nan(&app);
  try {
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
  } catch (const CLI::RequiredError& error) {
    const bool lacks_command = app.get_subcommands().empty();
    if (!lacks_command || argc < 2 || argv[1][0] == '-') return app.exit(error) == 0 ? 0 : 2;
    std::fprintf(stderr, "rio: %s is no command; rio --help lists them\n", argv[1]);
    return 2;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return 0;
}

}  // namespace

}  // namespace rio::tools

int main(int argc, char** argv) {
  const auto failed = [](const std::exception& error, int status) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return status;
  };
  try {
    return rio::tools::run(argc, argv);
  } catch (const rio::tools::WrongResult& error) {
    return failed(error, 3);
  } catch (const std::exception& error) {
    return failed(error, 1);
  }
}

// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program. Exit codes: 0 success, 1 the command failed, 2 wrong command line.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "commands.hpp"

namespace {

int run(int argc, char** argv) {
  CLI::App app("Radar-inertial odometry: replay, simulate, evaluate and compare", "rio");
  app.set_version_flag("--version", RIO_VERSION);
  app.require_subcommand(1);
  rio::tools::add_replay_command(app);
  rio::tools::add_simulate_command(app);
  rio::tools::add_scenarios_command(app);
  rio::tools::add_evaluate_command(app);
  rio::tools::add_experiment_command(app);
  rio::tools::add_plot_command(app);
  rio::tools::add_fit_noise_command(app);
  rio::tools::add_options_command(app);
  try {
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 1;
  }
}

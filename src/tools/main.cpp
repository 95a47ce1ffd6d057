// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program. Exit codes: 0 success, 1 the command failed, 2 wrong command line, 3 the
// estimate is lost, or the recording or configuration is wrong.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>

#include "command_line.hpp"
#include "commands.hpp"
#include "describe.hpp"
#include "version.hpp"

namespace rio::tools {

namespace {

void add_evaluate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("evaluate", "Compare an estimated path with the true one");
  auto arguments = std::make_shared<EvaluateArguments>();
  command->add_option("TRUTH", arguments->truth, "TUM file, EuRoC csv, dataset folder or bag")
      ->required();
  command
      ->add_option("ESTIMATE", arguments->estimates,
                   "same formats; several give a table of a row each")
      ->required();
  command
      ->add_option("--align", arguments->align,
                   "for MAE, RMSE, drift, yaw and tilt: none (as the papers), origin, yaw, se3")
      ->check(CLI::IsMember({"none", "origin", "yaw", "se3"}))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "print one JSON line an estimate");
  command
      ->add_option("--max-diff", arguments->max_diff,
                   "largest difference of stamps if the truth is too sparse to interpolate [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--mae-at", arguments->mae_at,
                   "also the norm of MAE up to this length of the true path [m]")
      ->check(CLI::PositiveNumber);
  command->callback([arguments] { evaluate(*arguments); });
}

/// rio-lab has its own options and its own help.
void add_experiment_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "experiment", "Answer a question with many simulated flights (starts rio-lab)");
  command->prefix_command();
  command->set_help_flag();
  command->callback([command] { experiment(command->remaining()); });
}

void add_plot_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("plot", "Draw paths, heights and errors as an SVG file");
  auto arguments = std::make_shared<PlotArguments>();
  command
      ->add_option("ESTIMATE", arguments->estimates, "TUM file, EuRoC csv, dataset folder or bag")
      ->required();
  CLI::Option* truth =
      command->add_option("--truth", arguments->truth, "true path: same formats; adds the errors");
  command->add_option("--label", arguments->labels, "names for the legend, one for each estimate");
  command
      ->add_option("--align", arguments->align,
                   "lay the estimates over the truth first: none, origin, yaw, se3")
      ->check(CLI::IsMember({"none", "origin", "yaw", "se3"}))
      ->needs(truth)
      ->capture_default_str();
  command->add_option("--out", arguments->out, "SVG file to write")->required();
  command->callback([arguments] { plot(*arguments); });
}

void add_scenarios_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("scenarios", "List the scenarios, or print one as a file");
  auto name = std::make_shared<std::string>();
  command->add_option("SCENARIO", *name, "name or file, printed with every value and its meaning");
  command->callback([name] { scenarios(*name); });
}

int run(int argc, char** argv) {
  CLI::App app("Radar-inertial odometry: replay, simulate, evaluate and compare", "rio");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  add_info_command(app);
  add_convert_command(app);
  add_check_command(app);
  add_ti_config_command(app);
  add_replay_command(app);
  add_live_command(app);
  add_bench_command(app);
  add_simulate_command(app);
  add_scenarios_command(app);
  add_evaluate_command(app);
  add_compare_command(app);
  add_experiment_command(app);
  add_plot_command(app);
  add_fit_noise_command(app);
  add_calibrate_command(app);
  add_options_command(app);
  add_describe_command(app);
  refuse_nan(&app);
  try {
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return 0;
}

}  // namespace

}  // namespace rio::tools

int main(int argc, char** argv) {
  try {
    return rio::tools::run(argc, argv);
  } catch (const rio::tools::LostEstimate& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 3;
  } catch (const rio::tools::WrongRecording& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 3;
  } catch (const rio::tools::WrongConfiguration& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 1;
  }
}

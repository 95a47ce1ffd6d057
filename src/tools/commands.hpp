// SPDX-License-Identifier: BSD-3-Clause
// The commands of the `rio` program. Each adds itself to the command line; when chosen it runs and
// throws std::runtime_error on failure.
#pragma once

namespace CLI {
class App;
}

namespace rio::tools {

void add_replay_command(CLI::App& app);
void add_options_command(CLI::App& app);
void add_simulate_command(CLI::App& app);
void add_scenarios_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_experiment_command(CLI::App& app);
void add_plot_command(CLI::App& app);
void add_fit_noise_command(CLI::App& app);

}  // namespace rio::tools

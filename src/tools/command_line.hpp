// SPDX-License-Identifier: BSD-3-Clause
// The command line of every command of `rio`, each added to the program by a function.
#pragma once

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "estimator_options.hpp"

namespace rio::tools {

struct ViewArguments;

/// Makes options that take a number refuse nan, for which every range has room, and whole numbers
/// too large for 64 bits, which would be cut.
inline void refuse_no_numbers(CLI::App* app) {
  const CLI::Validator is_number(
      [](std::string& text) {
        double value = 0.0;
        const bool nan = CLI::detail::lexical_cast(text, value) && std::isnan(value);
        return nan ? text + " is not a number" : std::string();
      },
      "");
  const CLI::Validator fits(
      [](std::string& text) {
        errno = 0;
        (void)std::strtoull(text.c_str(), nullptr, 0);
        return errno == ERANGE ? text + " is too large" : std::string();
      },
      "");
  for (CLI::Option* option : app->get_options()) {
    if (option->get_type_name().rfind("FLOAT", 0) == 0) option->check(is_number);
    if (option->get_type_name().rfind("UINT", 0) == 0) option->check(fits);
  }
  for (CLI::App* command : app->get_subcommands({})) refuse_no_numbers(command);
}

/// CLI::PositiveNumber and CLI::NonNegativeNumber say the largest double in all its digits.
inline const CLI::Validator kPositive(
    [](std::string& text) {
      double value = 0.0;
      const bool good = CLI::detail::lexical_cast(text, value) && value > 0.0;
      return good ? std::string() : text + " is not above 0";
    },
    "POSITIVE");
inline const CLI::Validator kNotNegative(
    [](std::string& text) {
      double value = 0.0;
      const bool good = CLI::detail::lexical_cast(text, value) && value >= 0.0;
      return good ? std::string() : text + " is below 0";
    },
    "NONNEGATIVE");

/// Of an option, besides what its value must be.
enum class Trait {
  kRequired,
  kShown,    ///< its default, in the help
  kOneEach,  ///< takes one value each time it is given
};

/// A command of the program.
class Command {
 public:
  Command(CLI::App& app, const std::string& name, const std::string& what)
      : app_(app.add_subcommand(name, what)) {}

  /// Of the same command: options under another heading of its help.
  Command under(std::string heading) const {
    Command command = *this;
    command.heading_ = std::move(heading);
    return command;
  }

  /// Where the options go; `run` gets them when the command line is read.
  template <class Arguments>
  Arguments* runs(void (*run)(const Arguments&)) const {
    auto arguments = std::make_shared<Arguments>();
    app_->callback([arguments, run] { run(*arguments); });
    return arguments.get();
  }

  /// An option, a positional argument if its name has no dash, a flag for a bool.
  /// @param settings Trait, what the value must be, or the option that this one needs
  template <class Value, class... Settings>
  CLI::Option* add(const std::string& name, Value* to, const std::string& what,
                   const Settings&... settings) const {
    CLI::Option* option = nullptr;
    if constexpr (std::is_same_v<Value, bool>) {
      option = app_->add_flag(name, *to, what);
    } else {
      option = app_->add_option(name, *to, what);
    }
    option->group(heading_);
    (set(option, settings), ...);
    return option;
  }

  CLI::App* operator->() const { return app_; }

 private:
  static void set(CLI::Option* option, const CLI::Validator& check) { option->check(check); }
  static void set(CLI::Option* option, CLI::Option* needed) { option->needs(needed); }
  static void set(CLI::Option* option, Trait trait) {
    if (trait == Trait::kRequired) option->required();
    if (trait == Trait::kShown) option->capture_default_str();
    if (trait == Trait::kOneEach) option->allow_extra_args(false);
  }

  CLI::App* app_;
  std::string heading_ = "Options";
};

/// Option file and single options.
void add_option_values(const Command& command, OptionValues* values, const std::string& what);

/// Common options of every command that runs the estimator.
void add_estimator_options(const Command& command, EstimatorArguments* estimator);

/// Files with the estimate at each scan.
void add_path_files(const Command& command, std::string* out, std::string* states);

/// Report, log and viewers, of every command that runs the estimator over time.
void add_view_options(const Command& command, ViewArguments* view);

/// In the order of the help.
/// @{
void add_info_command(CLI::App& app);
void add_convert_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_ti_config_command(CLI::App& app);
void add_replay_command(CLI::App& app);
void add_live_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_simulate_command(CLI::App& app);
void add_scenarios_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_experiment_command(CLI::App& app);
void add_plot_command(CLI::App& app);
void add_fit_noise_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_options_command(CLI::App& app);
/// @}

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program, its manual page and its completions. Exit codes: 0 success, 1 the command
// failed, 2 wrong command line, 3 the estimate is lost, or the recording or configuration is wrong.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "commands.hpp"
#include "version.hpp"

namespace rio::tools {

namespace {

/// In the order of the help, without hidden ones.
std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}
std::vector<const CLI::Option*> options_of(const CLI::App& command, bool positional) {
  return command.get_options([positional](const CLI::Option* option) {
    return !option->get_group().empty() && option->get_positional() == positional;
  });
}

/// "--help" of "-h,--help"; "FILE" of a positional argument.
std::string name_of(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name() : "--" + option.get_lnames().front();
}

/// "ekf smoother" for an option with these values; else empty.
std::string words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{');
  const std::size_t end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  std::string words = type.substr(begin + 1, end - begin - 1);
  std::replace(words.begin(), words.end(), ',', ' ');
  return words;
}

/// Escaped text for troff: no line is a request, hyphens are minus signs.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool first = out.empty() || out.back() == '\n';
    if (first && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else {
      out += c == '-' ? "\\-" : std::string(1, c);
    }
  }
  return out;
}

std::string option_text(const CLI::Option& option) {
  std::string value;
  const std::string words = words_of(option);
  if (option.get_items_expected_max() > 0 && !option.get_positional()) {
    value = words.empty() ? option.get_type_name() : "{" + words + "}";
    value = value.substr(0, value.find(':'));
  }
  const std::string standard =
      option.get_default_str().empty() ? "" : " [" + option.get_default_str() + "]";
  return fmt::format(".TP\n.B {} {}\n{}{}\n", troff(name_of(option)), troff(value),
                     troff(option.get_description()), troff(standard));
}

std::string command_text(const CLI::App& command) {
  std::string use;
  for (const CLI::Option* option : options_of(command, true)) {
    const std::string name =
        option->get_name() + (option->get_items_expected_max() > 1 ? "..." : "");
    use += option->get_required() ? " " + name : " [" + name + "]";
  }
  std::string text = fmt::format(".SS rio {}{} [OPTION...]\n{}.\n", troff(command.get_name()),
                                 troff(use), troff(command.get_description()));
  for (const bool positional : {true, false}) {
    for (const CLI::Option* option : options_of(command, positional)) text += option_text(*option);
  }
  return text;
}

std::string man_page(const CLI::App& app) {
  std::string text = fmt::format(
      ".TH RIO 1 \"\" \"rio {}\"\n.SH NAME\nrio \\- radar\\-inertial odometry\n.SH SYNOPSIS\n"
      ".B rio\nCOMMAND [OPTION...]\n.SH DESCRIPTION\n{}.\n.SH COMMANDS\n",
      RIO_VERSION, troff(app.get_description()));
  for (const CLI::App* command : commands_of(app)) text += command_text(*command);
  return text +
         ".SH EXIT STATUS\n0 success, 1 the command failed, 2 wrong command line, 3 the estimate "
         "is lost, or the\nrecording or configuration is wrong.\n";
}

std::string bash_completion(const CLI::App& app) {
  std::string names;
  std::string flags;
  std::string values;
  for (const CLI::App* command : commands_of(app)) {
    names += command->get_name() + " ";
    flags += "    " + command->get_name() + ") words=\"";
    for (const CLI::Option* option : options_of(*command, false)) {
      flags += name_of(*option) + " ";
      if (words_of(*option).empty()) continue;
      values += fmt::format("    \"{} {}\") words=\"{}\" ;;\n", command->get_name(),
                            name_of(*option), words_of(*option));
    }
    flags += "\" ;;\n";
  }
  return "# Completions of bash for rio; files where nothing else fits.\n_rio() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} words=\"\"\n"
         "  case \"${COMP_WORDS[1]} ${COMP_WORDS[COMP_CWORD - 1]}\" in\n" +
         values + "  esac\n  if [[ $COMP_CWORD == 1 ]]; then words=\"" + names +
         "--help --version\"; fi\n  if [[ $COMP_CWORD -gt 1 && $current == -* ]]; then\n"
         "    case \"${COMP_WORDS[1]}\" in\n" +
         flags +
         "    esac\n  fi\n  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n}\n"
         "complete -o default -F _rio rio\n";
}

/// The hidden command `rio describe man|bash`: prints the manual page or the bash completions, from
/// the description of the command line; the build calls it.
void add_describe_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("describe", "Print the manual page or the completions");
  command->group("");
  auto form = std::make_shared<std::string>();
  command->add_option("FORM", *form, "man or bash")
      ->required()
      ->check(CLI::IsMember({"man", "bash"}));
  command->callback(
      [&app, form] { fmt::print("{}", *form == "man" ? man_page(app) : bash_completion(app)); });
}

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
  refuse_no_numbers(&app);
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
    (void)std::fflush(stdout);  // what was said before stands before it
    std::fprintf(stderr, "rio: %s\n", error.what());
    return status;
  };
  try {
    return rio::tools::run(argc, argv);
  } catch (const rio::tools::WrongResult& error) {
    return failed(error, 3);
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(std::runtime_error(error.path1().string() + ": " + error.code().message()), 1);
  } catch (const std::exception& error) {
    return failed(error, 1);
  }
}

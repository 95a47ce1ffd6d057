// SPDX-License-Identifier: BSD-3-Clause
// The `rio-lab` program, started by `rio experiment`: runs an experiment, prints its tables, writes
// them with their data and charts. Exit codes: 0 success, 1 the experiment failed, 2 wrong command
// line.
#include <fmt/chrono.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "rio/io/csv.hpp"
#include "tools/command_line.hpp"
#include "tools/outputs.hpp"
#include "tools/progress.hpp"
#include "tools/version.hpp"

namespace {

namespace fs = std::filesystem;
using rio::experiment::Attachment;
using rio::experiment::Experiment;
using rio::experiment::kExperiments;
using rio::experiment::Settings;
using rio::tools::write_text;

struct Arguments {
  std::string name;
  Settings settings;
  std::string out = "out";
  std::string update;
};

constexpr const char* kBegin = "<!-- rio experiment ";
constexpr const char* kEnd = "<!-- end -->";

/// Replaces the text between `<!-- rio experiment NAME -->` and the next `<!-- end -->`.
/// @throws std::runtime_error if the page has no such block; it is unchanged then
void replace_block(const fs::path& page, const std::string& name, const std::string& markdown) {
  const std::string begin = kBegin + name + " -->";
  std::string text = rio::io::read_text(page);
  const std::size_t from = text.find(begin + "\n");
  const std::size_t to = from == std::string::npos ? from : text.find(kEnd, from);
  if (to == std::string::npos) {
    throw std::runtime_error(page.string() + ": no block from \"" + begin + "\" to \"" + kEnd +
                             "\"");
  }
  write_text(page, text.replace(from, to - from, begin + "\n\n" + markdown + "\n"));
}

/// The experiments that have a block, in the order of the page.
std::vector<std::string> blocks_of(const fs::path& page) {
  const std::string begin = kBegin;
  const std::string text = rio::io::read_text(page);
  std::vector<std::string> names;
  for (std::size_t at = 0; (at = text.find(begin, at)) != std::string::npos;) {
    at += begin.size();
    names.push_back(text.substr(at, text.find(" -->", at) - at));
  }
  return names;
}

/// Below every report: the day, and the program that made it.
std::string signature() {
  const std::string version = rio::tools::version_text();
  return fmt::format("\nWritten on {:%Y-%m-%d} by version {}.\n", fmt::gmtime(std::time(nullptr)),
                     version.substr(0, version.find('\n')));
}

/// @param name prefix of progress lines if stderr is not a terminal; empty: none
void run_experiment(const Arguments& arguments, const std::string& name = {}) {
  const auto chosen = std::find_if(std::begin(kExperiments), std::end(kExperiments),
                                   [&](const Experiment& e) { return e.name == arguments.name; });
  if (chosen == std::end(kExperiments)) {
    throw std::runtime_error("no such experiment: " + arguments.name);
  }
  const fs::path out(arguments.out);
  fs::create_directories(out);
  rio::experiment::Result result;
  {
    rio::tools::Progress progress(true, name);
    Settings settings = arguments.settings;
    settings.on_progress = [&](std::size_t done, std::size_t total) { progress.show(done, total); };
    result = chosen->run(settings);
  }
  result.markdown += signature();
  std::fputs(result.markdown.c_str(), stdout);
  write_text(out / (arguments.name + ".md"), result.markdown);
  for (const Attachment& file : result.attachments) write_text(out / file.name, file.text);
  if (arguments.update.empty()) return;
  replace_block(arguments.update, arguments.name, result.markdown);
  for (const Attachment& file : result.attachments) {
    const fs::path beside = fs::path(arguments.update).parent_path() / file.name;
    if (fs::exists(beside)) write_text(beside, file.text);  // a chart of the page
  }
}

/// Every table of the page that this program has not written yet with the same arguments. A file
/// beside the reports has a line for each written one, so that a long series can be resumed.
void run_all(Arguments arguments) {
  if (arguments.update.empty()) throw std::runtime_error("all needs --update PAGE");
  fs::create_directories(arguments.out);
  const fs::path list = fs::path(arguments.out) / "written.txt";
  const std::size_t program = std::hash<std::string>{}(rio::io::read_text("/proc/self/exe"));
  const std::string how = std::to_string(program) + " seeds " +
                          std::to_string(arguments.settings.seeds) + " of " + arguments.update +
                          " ";
  for (const std::string& name : blocks_of(arguments.update)) {
    const std::string written = fs::exists(list) ? rio::io::read_text(list) : "";
    if (("\n" + written).find("\n" + how + name + "\n") != std::string::npos) {
      std::fprintf(stderr, "%s: written by this program already\n", name.c_str());
      continue;
    }
    arguments.name = name;
    run_experiment(arguments, name);
    write_text(list, written + how + name + "\n");
  }
}

int run(int argc, char** argv) {
  CLI::App app("Answer a question with many simulated flights", "rio experiment");
  app.set_version_flag("--version", rio::tools::version_text());
  Arguments arguments;
  std::vector<std::string> names;
  std::string footer = "Experiments:\n";
  for (const Experiment& e : kExperiments) {
    names.emplace_back(e.name);
    footer += std::string("  ") + e.name + ": " + e.summary + "\n";
  }
  footer += "  all: every table of the page --update that this program has not written yet\n";
  names.emplace_back("all");
  app.footer(footer);
  app.add_option("NAME", arguments.name, "of the experiment")
      ->required()
      ->check(CLI::IsMember(names));
  app.add_option("--seeds", arguments.settings.seeds,
                 "flights of a kind, instead of the usual number")
      ->check(CLI::Range(1, 10000));
  app.add_option("--threads", arguments.settings.threads, "flights at a time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option(
      "--data", arguments.settings.data,
      "folder of recordings, for `real`, `control`, `ablation-real`, `benchmark`, `checks`");
  app.add_option("--dataset", arguments.settings.dataset,
                 "public data set of the bags, for `benchmark`, as of `rio replay`");
  app.add_option("--out", arguments.out, "folder for report, data and charts")
      ->capture_default_str();
  app.add_option(
      "--update", arguments.update,
      "Markdown file in which the block of this experiment is replaced, and its charts beside it");
  rio::tools::refuse_no_numbers(&app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (arguments.name == "all") {
    run_all(arguments);
  } else {
    run_experiment(arguments);
  }
  if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rio experiment: %s\n", error.what());
    return 1;
  }
}

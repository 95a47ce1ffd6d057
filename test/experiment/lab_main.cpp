// SPDX-License-Identifier: BSD-3-Clause
// The `rio-lab` program, started by `rio experiment`: runs an experiment, prints its tables, writes
// them with their data and charts. Exit codes: 0 success, 1 the experiment failed, 2 wrong command
// line.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/results_block.hpp"
#include "experiment/written_tables.hpp"
#include "rio/io/text_file.hpp"
#include "tools/command_line.hpp"
#include "tools/progress.hpp"
#include "tools/version.hpp"

namespace {

namespace fs = std::filesystem;
using rio::experiment::Experiment;

struct Arguments {
  std::string name;
  int seeds = 0;
  int threads = 2;
  std::string data;
  std::string dataset;
  double hours = 24.0;
  std::string backend = "ekf";
  std::string out = "out";
  std::string update;
};

void write(const fs::path& path, const std::string& text) {
  rio::io::TextFile file(path);
  file.write(text);
  file.close();
}

/// @param name prefix of progress lines if stderr is not a terminal; empty: none
void run_experiment(const Arguments& arguments, const std::string& name = {}) {
  const std::vector<Experiment>& all = rio::experiment::experiments();
  const auto chosen = std::find_if(all.begin(), all.end(),
                                   [&](const Experiment& e) { return e.name == arguments.name; });
  if (chosen == all.end()) throw std::runtime_error("no such experiment: " + arguments.name);
  const fs::path out(arguments.out);
  fs::create_directories(out);
  rio::experiment::Result result;
  {
    rio::tools::Progress progress(true, name);
    const rio::experiment::Settings settings{
        arguments.seeds,
        arguments.threads,
        arguments.data,
        arguments.hours,
        arguments.backend == "smoother",
        [&](std::size_t done, std::size_t total) { progress.show(done, total); },
        arguments.dataset};
    result = chosen->run(settings);
  }
  std::fputs(result.markdown.c_str(), stdout);
  write(out / (arguments.name + ".md"), result.markdown);
  for (const rio::experiment::Attachment& file : result.attachments)
    write(out / file.name, file.text);
  if (arguments.update.empty()) return;
  rio::experiment::replace_results_block(arguments.update, arguments.name, result.markdown);
  for (const rio::experiment::Attachment& file : result.attachments) {
    const fs::path beside = fs::path(arguments.update).parent_path() / file.name;
    if (fs::exists(beside)) write(beside, file.text);  // a chart of the page
  }
}

/// Every table of the page that this program has not written yet with the same arguments.
void run_all(Arguments arguments) {
  if (arguments.update.empty()) throw std::runtime_error("all needs --update PAGE");
  fs::create_directories(arguments.out);
  const std::string how = rio::experiment::fingerprint("/proc/self/exe") + " seeds " +
                          std::to_string(arguments.seeds) + " of " + arguments.update;
  rio::experiment::WrittenTables written(fs::path(arguments.out) / "written.txt", how);
  for (const std::string& name : rio::experiment::results_blocks(arguments.update)) {
    if (written.has(name)) {
      std::fprintf(stderr, "%s: written by this program already\n", name.c_str());
      continue;
    }
    arguments.name = name;
    run_experiment(arguments, name);
    written.add(name);
  }
}

int run(int argc, char** argv) {
  CLI::App app("Answer a question with many simulated flights", "rio experiment");
  app.set_version_flag("--version", rio::tools::version_text());
  Arguments arguments;
  std::vector<std::string> names;
  std::string footer = "Experiments:\n";
  for (const Experiment& e : rio::experiment::experiments()) {
    names.emplace_back(e.name);
    footer += std::string("  ") + e.name + ": " + e.summary + "\n";
  }
  footer += "  all: every table of the page --update that this program has not written yet\n";
  names.emplace_back("all");
  app.footer(footer);
  app.add_option("NAME", arguments.name, "of the experiment")
      ->required()
      ->check(CLI::IsMember(names));
  app.add_option("--seeds", arguments.seeds, "flights of a kind, instead of the usual number")
      ->check(CLI::Range(1, 10000));
  app.add_option("--threads", arguments.threads, "flights at a time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--data", arguments.data,
                 "folder of recordings, for `real`, `benchmark`, `control` and `checks`");
  app.add_option("--dataset", arguments.dataset,
                 "public data set of the bags, for `benchmark`, as of `rio replay`");
  app.add_option("--hours", arguments.hours, "of flight, for `soak`")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  app.add_option("--backend", arguments.backend, "for `soak`")
      ->check(CLI::IsMember({"ekf", "smoother"}))
      ->capture_default_str();
  app.add_option("--out", arguments.out, "folder for report, data and charts")
      ->capture_default_str();
  app.add_option(
      "--update", arguments.update,
      "Markdown file in which the block of this experiment is replaced, and its charts beside it");
  rio::tools::refuse_nan(&app);
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

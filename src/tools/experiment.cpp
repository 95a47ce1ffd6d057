// SPDX-License-Identifier: BSD-3-Clause
// `rio experiment`: runs an experiment, prints its tables, writes them with their data and charts.
#include "experiment/experiment.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "progress.hpp"
#include "results_block.hpp"
#include "rio/io/text_file.hpp"

namespace rio::tools {

namespace {

struct Arguments {
  std::string name;
  int seeds = 0;
  int threads = 2;
  std::string out = "out";
  std::string update;
};

void write(const std::filesystem::path& path, const std::string& text) {
  io::TextFile file(path);
  file.write(text);
  file.close();
}

void run(const Arguments& arguments) {
  const std::vector<experiment::Experiment>& all = experiment::experiments();
  const auto chosen =
      std::find_if(all.begin(), all.end(), [&](const auto& e) { return e.name == arguments.name; });
  const std::filesystem::path out(arguments.out);
  std::filesystem::create_directories(out);
  experiment::Result result;
  {
    Progress progress(true);
    const experiment::Settings settings{
        arguments.seeds, arguments.threads,
        [&](std::size_t done, std::size_t total) { progress.show(done, total); }};
    result = chosen->run(settings);
  }
  std::fputs(result.markdown.c_str(), stdout);
  write(out / (arguments.name + ".md"), result.markdown);
  for (const experiment::Attachment& file : result.attachments) write(out / file.name, file.text);
  if (!arguments.update.empty()) {
    replace_results_block(arguments.update, arguments.name, result.markdown);
  }
}

}  // namespace

void add_experiment_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("experiment", "Answer a question with many simulated flights");
  auto arguments = std::make_shared<Arguments>();
  std::vector<std::string> names;
  std::string footer = "Experiments:\n";
  for (const experiment::Experiment& e : experiment::experiments()) {
    names.emplace_back(e.name);
    footer += std::string("  ") + e.name + ": " + e.summary + "\n";
  }
  command->footer(footer);
  command->add_option("NAME", arguments->name, "of the experiment")
      ->required()
      ->check(CLI::IsMember(names));
  command->add_option("--seeds", arguments->seeds, "flights of a kind, instead of the usual number")
      ->check(CLI::Range(1, 10000));
  command->add_option("--threads", arguments->threads, "flights at a time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_option("--out", arguments->out, "folder for report, data and charts")
      ->capture_default_str();
  command->add_option("--update", arguments->update,
                      "Markdown file in which the block of this experiment is replaced");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// `rio scenarios`: the catalogue of simulated flights, or one of them with units and meaning.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "commands.hpp"
#include "rio/io/scenario_yaml.hpp"
#include "rio/sim/catalogue.hpp"

namespace rio::tools {

namespace {

void run(const std::string& name_or_file) {
  if (!name_or_file.empty()) {
    fmt::print("{}", io::scenario_as_yaml(io::load_scenario(name_or_file)));
    return;
  }
  for (const sim::CatalogueEntry& entry : sim::catalogue()) {
    fmt::print("{:16}{}\n", entry.name, entry.summary);
  }
}

}  // namespace

void add_scenarios_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("scenarios", "List the scenarios, or print one as a file");
  auto name = std::make_shared<std::string>();
  command->add_option("SCENARIO", *name, "name or file, printed with every value and its meaning");
  command->callback([name] { run(*name); });
}

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// `rio scenarios`: the catalogue of simulated flights, or one of them with units and meaning.
#include <fmt/format.h>

#include <string>

#include "commands.hpp"
#include "rio/io/scenario_yaml.hpp"
#include "rio/sim/catalogue.hpp"

namespace rio::tools {

void scenarios(const std::string& name_or_file) {
  if (!name_or_file.empty()) {
    fmt::print("{}", io::scenario_as_yaml(io::load_scenario(name_or_file)));
    return;
  }
  for (const sim::CatalogueEntry& entry : sim::catalogue()) {
    fmt::print("{:16}{}\n", entry.name, entry.summary);
  }
}

}  // namespace rio::tools

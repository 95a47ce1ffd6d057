// SPDX-License-Identifier: BSD-3-Clause
// The named scenarios: conditions that such an estimator must survive. Each differs from the
// default scenario by a few values.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/sim/scenario.hpp"

namespace rio::sim {

/// One scenario of the catalogue.
struct CatalogueEntry {
  const char* name;
  const char* summary;
  void (*apply)(Scenario& s);
};

/// Path lengths of the seven flights of Michalczyk et al., ICRA 2023, Table I [m].
inline constexpr std::array<double, 7> kIcraLengths = {127.5, 150.5, 158.4, 160.4,
                                                       166.7, 168.1, 175.0};

/// The whole catalogue, in the order of the reports. Names are unique.
const std::vector<CatalogueEntry>& catalogue();

/// The scenario named `name` with its default seed; false and unchanged if there is no such.
bool scenario(const std::string& name, Scenario* out);

}  // namespace rio::sim

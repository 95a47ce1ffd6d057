// SPDX-License-Identifier: BSD-3-Clause
// Scenarios of the catalogue, and the beginnings of their flights.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "rio/sim/catalogue.hpp"
#include "rio/sim/flight.hpp"

namespace rio::test {

/// @throws std::runtime_error if the catalogue has no such scenario
inline sim::Scenario scenario_named(const std::string& name, std::uint64_t seed = 1) {
  sim::Scenario scenario;
  if (!sim::scenario(name, &scenario)) {
    throw std::runtime_error("no such scenario: \"" + name + "\"");
  }
  scenario.seed = seed;
  return scenario;
}

/// The first `seconds` of a named scenario.
inline sim::Flight short_flight(const std::string& name, double seconds, std::uint64_t seed = 1) {
  sim::Scenario scenario = scenario_named(name, seed);
  scenario.max_duration = seconds;
  return sim::simulate_flight(scenario);
}

}  // namespace rio::test

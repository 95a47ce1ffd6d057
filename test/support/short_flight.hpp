// SPDX-License-Identifier: BSD-3-Clause
// The beginning of a flight of the catalogue.
#pragma once

#include <cstdint>
#include <string>

#include "experiment/campaign.hpp"
#include "rio/sim/flight.hpp"

namespace rio::test {

/// The first `seconds` of a named scenario.
inline sim::Flight short_flight(const std::string& name, double seconds, std::uint64_t seed = 1) {
  sim::Scenario scenario = experiment::cases_of(name, 1, seed).front().scenario;
  scenario.max_duration = seconds;
  return sim::simulate_flight(scenario);
}

}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights as recordings, for tests of the checks.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "rio/io/dataset.hpp"
#include "rio/sim/catalogue.hpp"
#include "rio/sim/flight.hpp"

namespace rio::test {

inline io::Dataset flown(const sim::Scenario& scenario) {
  const sim::Flight flight = sim::simulate_flight(scenario);
  io::Dataset out;
  out.imu = flight.imu;
  out.scans = flight.scans;
  out.radar_info.T_BS = flight.configured_T_BS;
  if (scenario.radar.ambiguous) out.radar_info.max_doppler = scenario.radar.reported_max_doppler();
  out.radar_info.doppler_resolution = scenario.radar.reported_doppler_resolution();
  out.radar_info.rate_hz = scenario.radar.rate_hz;
  return out;
}

inline io::Dataset flown(const std::string& name, double length) {
  sim::Scenario scenario;
  EXPECT_TRUE(sim::scenario(name, &scenario)) << name;
  scenario.path.length = length;
  return flown(scenario);
}

/// One with which nothing is wrong.
inline const io::Dataset& flight() {
  static const io::Dataset kFlight = flown("indoor-1", 50.0);
  return kFlight;
}

}  // namespace rio::test

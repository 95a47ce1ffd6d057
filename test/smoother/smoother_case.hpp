// SPDX-License-Identifier: BSD-3-Clause
// A short flight with ideal sensors, scan by scan, with the sliding window as back-end.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "support/scanwise_flight.hpp"

namespace rio::test {

inline sim::Scenario short_flight(std::uint64_t seed) {
  sim::Scenario scenario = sim::Scenario::ideal();
  scenario.seed = seed;
  scenario.path.length = 20.0;
  scenario.path.stand_before = 1.5;
  return scenario;
}

class SmootherTest : public testing::Test {
 protected:
  SmootherTest() : flight_(short_flight(8)) { flight_.begin(flight_.options()); }

  void fly(std::size_t scans) {
    for (std::size_t i = 0; i < scans; ++i) ASSERT_EQ(flight_.step(), Status::kOk);
  }
  const Window& window() const { return flight_.back_end().window(); }
  const Estimate& x() const { return flight_.estimate(); }

  SmootherFlight flight_;
};

}  // namespace rio::test

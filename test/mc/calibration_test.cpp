// SPDX-License-Identifier: BSD-3-Clause
// Simulated radars that are late, scaled or tilted: what the default finds out about them, how sure
// it says it is, and what it says when it cannot know.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "experiment/campaign.hpp"
#include "rio/eval/nees.hpp"
#include "rio/sim/random.hpp"
#include "support/measured.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {
namespace {

/// A flight and what its last report says of one parameter of the calibration.
struct Result {
  Score score;
  CalibrationReport found;
};

using ChangeScenario = std::function<void(sim::Scenario&)>;
using ChangeOptions = std::function<void(Options&)>;

/// A flight with noise as the filter models it.
Result fly_one(Calibration parameter, std::uint64_t seed, double length,
               const ChangeScenario& change_scenario, const ChangeOptions& change_options = {}) {
  sim::Scenario scenario = test::scenario_named("monte-carlo", seed);
  scenario.path.length = length;
  change_scenario(scenario);
  const sim::Flight flight = sim::simulate_flight(scenario);
  Options options = options_for(flight, "default");
  if (change_options) change_options(options);
  Result result;
  result.score = score(fly(flight, options, [&](const UpdateReport& report) {
    result.found = report.calibration[static_cast<std::size_t>(parameter)];
  }));
  return result;
}

Result fly_late(std::uint64_t seed, double length, double offset) {
  return fly_one(Calibration::kTimeOffset, seed, length,
                 [offset](sim::Scenario& s) { s.radar.stamp_offset = offset; });
}

void expect_found(const CalibrationReport& found, double truth, std::uint64_t seed) {
  EXPECT_NEAR(found.value, truth, 0.003) << seed;  // sigma: 0.4 ms of the offset, 8e-4 of the scale
  EXPECT_NEAR(found.value, truth, 4.0 * found.sigma) << seed;
  EXPECT_EQ(found.observability, Observability::kObserved) << seed;
}

TEST(TimeOffset, IsFoundWithinMilliseconds) {
  for (const double offset : {0.03, -0.02, 0.067}) {  // the prior says 0.03
    for (const std::uint64_t seed : {401U, 402U, 403U}) {
      const Result result = fly_late(seed, 60.0, offset);
      expect_found(result.found, offset, seed);
      EXPECT_FALSE(result.score.lost) << seed;
      EXPECT_LT(result.score.drift, 1.0) << seed;  // as without an offset: 0.3 to 0.4 %
    }
  }
}

TEST(TimeOffset, ErrorAgreesWithItsSigma) {
  constexpr int kFlights = 14;
  double mean = 0.0;
  for (int i = 0; i < kFlights; ++i) {
    const auto seed = std::uint64_t{401} + static_cast<std::uint64_t>(i);
    const double offset = 0.03 * sim::Random(seed, 9).normal();  // a draw of the prior
    const CalibrationReport found = fly_late(seed, 20.0, offset).found;
    mean += std::pow((found.value - offset) / found.sigma, 2) / kFlights;
  }
  const eval::AneesBounds bounds = eval::anees_bounds(1, kFlights, 0.99);
  test::expect_between("NEES of the time offset", mean, bounds.lower, bounds.upper);
}

// A vibration of 87 Hz sampled 100 times a second is one of 13 Hz, which a radar of 15 Hz sees as
// one of 2 Hz: what it does to the velocity must not be taken for the body's acceleration.
TEST(TimeOffset, AliasedVibrationIsNone) {
  for (const std::uint64_t seed : {401U, 402U, 403U}) {
    const Result result = fly_one(Calibration::kTimeOffset, seed, 60.0, [](sim::Scenario& s) {
      s.imu.rate_hz = 100.0;
      s.imu.gyro_vibration = 0.05;
      s.imu.accel_vibration = 2.0;
    });
    // one and a half sigmas of its prior; without the low-pass of update/state_estimate.hpp it is
    // three
    EXPECT_LT(std::abs(result.found.value), 0.045) << seed;
    EXPECT_LT(result.score.drift, 1.0) << seed;
  }
}

TEST(TimeOffset, NothingIsSaidAtRest) {
  for (const std::uint64_t seed : {501U, 502U, 503U}) {
    const Result result = fly_one(Calibration::kTimeOffset, seed, 20.0, [](sim::Scenario& s) {
      s.radar.stamp_offset = 0.03;
      s.path.stand_before = 5.0;
      s.max_duration = 4.5;  // three seconds of scans after the alignment
    });
    EXPECT_EQ(result.found.observability, Observability::kUnobserved) << seed;
  }
}

TEST(TimeOffset, BeyondItsLimitItSaysSo) {
  for (const std::uint64_t seed : {401U, 402U}) {
    const Result result = fly_late(seed, 40.0, 0.2);
    const CalibrationReport& found = result.found;
    EXPECT_EQ(found.observability, Observability::kAtLimit) << seed;
    EXPECT_NEAR(found.value, kCalibrationLimit * found.prior_sigma, 1e-4) << seed;
    EXPECT_FALSE(result.score.lost) << seed;
    EXPECT_LT(result.score.drift, 2.0) << seed;  // the 50 ms that are left cost some 0.2 %
  }
}

TEST(DopplerScale, IsFoundWithinThreeThousandths) {
  for (const double scale : {0.027, -0.027}) {
    for (const std::uint64_t seed : {401U, 402U, 404U}) {
      const Result result = fly_one(
          Calibration::kDopplerScale, seed, 60.0,
          [scale](sim::Scenario& s) { s.radar.doppler_scale = scale; },
          [](Options& o) { o.calibration.doppler_scale_sigma = 0.03; });
      expect_found(result.found, scale, seed);
    }
  }
}

}  // namespace
}  // namespace rio::experiment

// SPDX-License-Identifier: BSD-3-Clause
// The noise of simulated radars, recovered from their flights.
#include "calibrate/noise_calibration.hpp"

#include <gtest/gtest.h>

#include "experiment/trial.hpp"
#include "support/constants.hpp"
#include "support/flight_recording.hpp"
#include "support/short_flight.hpp"

namespace rio::calibrate {
namespace {

/// Range [m], azimuth, elevation [rad], Doppler [m/s].
using Sigmas = Eigen::Vector4d;

struct Case {
  Sigmas truth;
  double factor;    ///< the start's sigmas over the true ones
  bool with_truth;  ///< the recording has ground truth
};

sim::Flight fly(const Sigmas& sigmas, std::uint64_t seed) {
  sim::Scenario scenario = test::scenario_named("monte-carlo", seed);
  scenario.radar.sigma_range = sigmas[0];
  scenario.radar.sigma_azimuth = sigmas[1];
  scenario.radar.sigma_elevation = sigmas[2];
  scenario.radar.sigma_doppler = sigmas[3];
  return sim::simulate_flight(scenario);
}

Options wrong_options(const sim::Flight& flight, double factor) {
  Options options = experiment::options_for(flight, "default");
  options.radar.sigma_range *= factor;
  options.radar.sigma_azimuth *= factor;
  options.radar.sigma_elevation *= factor;
  options.radar.sigma_doppler *= factor;
  return options;
}

TEST(NoiseCalibration, RecoversTheSigmasFromAFactorTwoEitherWay) {
  const Sigmas fine(0.02, 1.0 * kDegree, 2.0 * kDegree, 0.02);
  const Sigmas usual(0.04, 2.0 * kDegree, 4.0 * kDegree, 0.04);
  const Sigmas coarse(0.06, 3.0 * kDegree, 8.0 * kDegree, 0.06);
  for (const Case& c : {Case{fine, 0.5, true}, Case{usual, 2.0, false}, Case{coarse, 0.5, false},
                        Case{coarse, 2.0, true}}) {
    const sim::Flight flight = fly(c.truth, 11);
    Recording recording = test::recording_of(flight);
    if (c.with_truth) recording.truth = interpolated_truth(flight.truth);
    const NoiseCalibration result = calibrate_noise(recording, wrong_options(flight, c.factor));
    for (int k = 0; k < 4; ++k) {
      // landmarks taken to walk, and rivals of a match that errs far, cost up to a tenth
      EXPECT_NEAR(result.fit.noise.sigma[k] / c.truth[k], 1.0, 0.15) << k << " from " << c.factor;
      EXPECT_GT(result.fit.relative_error[k], 0.003);
      EXPECT_LT(result.fit.relative_error[k], 0.07);
    }
  }
}

TEST(NoiseCalibration, TruthIsInterpolatedAndNotExtrapolated) {
  NavState a;
  a.time = from_seconds(1.0);
  a.v_WB = {1.0, 0.0, 0.0};
  NavState b = a;
  b.time = from_seconds(1.05);
  b.v_WB = {2.0, 0.0, 0.0};
  NavState late = b;
  late.time = from_seconds(3.0);
  const TruthAt truth = interpolated_truth({a, b, late});
  ASSERT_TRUE(truth(from_seconds(1.025)));
  EXPECT_NEAR(truth(from_seconds(1.025))->v_WB.x(), 1.5, 1e-12);  // rounding
  EXPECT_FALSE(truth(from_seconds(0.99)));
  EXPECT_FALSE(truth(from_seconds(2.0))) << "inside a gap";
  EXPECT_FALSE(truth(from_seconds(3.1)));
  a.v_WB.setZero();
  EXPECT_FALSE(interpolated_truth({a})) << "a truth without velocity says nothing of the Doppler";
}

}  // namespace
}  // namespace rio::calibrate

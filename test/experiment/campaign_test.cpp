// SPDX-License-Identifier: BSD-3-Clause
// Trials and campaigns: what is fed, what is judged, and that threads change nothing.
#include "experiment/campaign.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/models/aids.hpp"
#include "rio/sim/flight.hpp"
#include "support/constants.hpp"

namespace rio::experiment {
namespace {

sim::Scenario short_scenario(std::uint64_t seed) {
  return {.seed = seed, .path = {.length = 20.0}, .max_duration = 15.0};
}

Cases short_cases() {
  Cases cases;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    cases.push_back({"short", short_scenario(seed)});
  }
  return cases;
}

const Variants& two_variants() {
  static const Variants variants = {
      {"default", "default"},
      {"no Doppler", "default", [](Options& o) { o.update.use_doppler = false; }}};
  return variants;
}

/// The four flights with both, flown once.
const Outcomes& runs() {
  static const Outcomes all = run_campaign(short_cases(), two_variants(), {.threads = 1});
  return all;
}

TEST(Campaign, RunsComeByCaseThenVariantWhateverTheThreadsAndEachIsShownOnce) {
  std::set<std::string> seen;
  const auto each = [&](const Case& c, const Variant& v, const Trial& trial) {
    EXPECT_FALSE(trial.steps.empty());
    EXPECT_TRUE(seen.insert(v.name + std::to_string(c.scenario.seed)).second);
  };
  std::vector<std::size_t> progress;
  const auto on_progress = [&](std::size_t done, std::size_t total) {
    progress.push_back(done);
    EXPECT_EQ(total, 4U);
  };
  const Outcomes three =
      run_campaign(short_cases(), two_variants(), {.threads = 3, .on_progress = on_progress}, each);
  EXPECT_EQ(progress, (std::vector<std::size_t>{1, 2, 3, 4}));
  ASSERT_EQ(runs().size(), 8U);
  EXPECT_EQ(outcomes_as_csv(runs()), outcomes_as_csv(three));
  EXPECT_EQ(runs()[2].seed, 2U);
  EXPECT_EQ(runs()[2].variant, "default");
  EXPECT_EQ(runs()[3].variant, "no Doppler");
  EXPECT_EQ(seen.size(), 8U);
}

TEST(Campaign, TheChangeReachesTheEstimator) {
  for (const Score& s : select(runs(), "short", "default")) EXPECT_FALSE(std::isnan(s.nis_doppler));
  for (const Score& s : select(runs(), "", "no Doppler")) EXPECT_TRUE(std::isnan(s.nis_doppler));
  EXPECT_EQ(select(runs(), "short", "default").size(), 4U);
  EXPECT_EQ(select(runs(), "", "default").size(), 4U);
  EXPECT_TRUE(select(runs(), "other", "default").empty());
}

TEST(Campaign, UnknownNamesAreErrors) {
  EXPECT_THROW(cases_of("nowhere", 1), std::runtime_error);
  EXPECT_THROW(run_campaign(short_cases(), {{"x", "no such preset"}}, {}), std::runtime_error);
  std::size_t flown = 0;
  const Variant bad = {"x", "default",
                       [&](Options& o) { o.update.max_clones = ++flown < 2 ? 7 : -1; }};
  EXPECT_THROW(run_campaign(short_cases(), {bad}, {.threads = 1}), std::runtime_error);
  EXPECT_EQ(flown, 2U);  // no case begins after a failure
}

TEST(Campaign, CsvHasARowARunAndAColumnAFigure) {
  Outcomes named = runs();
  named[0].variant = "a, b";
  const std::string csv = outcomes_as_csv(named);
  const auto count = [](const std::string& text, char c) {
    return std::count(text.begin(), text.end(), c);
  };
  EXPECT_EQ(count(csv, '\n'), 9);
  EXPECT_EQ(count(csv.substr(0, csv.find('\n')), ','), 4 + static_cast<long>(kFigures.size()));
  EXPECT_EQ(count(csv, ','), 1 + 9 * (4 + static_cast<long>(kFigures.size())));
  EXPECT_NE(csv.find("short,1,\"a, b\",1,0,"), std::string::npos);
}

TEST(Trial, TakesEveryScanAndKnowsTheTruth) {
  for (const double latency : {0.0, 0.08}) {
    SCOPED_TRACE(latency);
    sim::Scenario scenario = short_scenario(1);
    scenario.radar.latency = latency;
    const sim::Flight flight = sim::simulate_flight(scenario);
    const Trial trial = fly(flight, options_for(flight, "default"));
    EXPECT_TRUE(trial.complete);
    EXPECT_EQ(trial.counters.scans, trial.steps.size());
    // two scan periods, at most, lie between the end of the alignment and its arrival
    EXPECT_LE(trial.counters.scans_late, latency > 0.0 ? 2U : 0U);
    for (const Step& step : trial.steps) {
      ASSERT_EQ(step.truth.time, step.estimate.time);
      ASSERT_EQ(step.truth.p_WB, flight.trajectory.at(step.estimate.time).nav.p_WB);
    }
    // all but the scans before the alignment, 1.5 s at 15 Hz, and the last, which no IMU follows
    EXPECT_GE(trial.steps.size() + 25, flight.scans.size());
    EXPECT_LT((trial.steps.back().estimate.p_WB - trial.steps.back().truth.p_WB).norm(), 0.2);
  }
}

TEST(Trial, EveryPresetFliesWithEitherBackEnd) {
  const sim::Flight flight = sim::simulate_flight(short_scenario(6));
  EXPECT_EQ(options_for(flight, "default").backend, BackEnd::kEkf);
  EXPECT_EQ(options_for(flight, "published-ekf").backend, BackEnd::kEkf);
  EXPECT_EQ(options_for(flight, "published-smoother").backend, BackEnd::kSmoother);
  for (const char* preset : kPresets) {
    std::vector<Trial> trials;
    for (const BackEnd backend : {BackEnd::kEkf, BackEnd::kSmoother}) {
      Options o = options_for(flight, preset);
      o.backend = backend;
      trials.push_back(fly(flight, o));
      EXPECT_TRUE(trials.back().complete) << preset;
      EXPECT_FALSE(score(trials.back()).lost) << preset;
    }
    ASSERT_EQ(trials[0].steps.size(), trials[1].steps.size()) << preset;
    EXPECT_NE(trials[0].steps.back().estimate.p_WB, trials[1].steps.back().estimate.p_WB) << preset;
  }
}

TEST(Trial, ABarometerMeasuresIfItsZeroIsDeclared) {
  const sim::Flight flight = sim::simulate_flight(short_scenario(2));
  Options options = options_for(flight, "default");
  const auto aiding = [&] {
    return fly(flight, options).models[static_cast<std::size_t>(Model::kAiding)];
  };
  EXPECT_EQ(aiding().rows_used, 0);
  ASSERT_TRUE(options.auxiliary.declare<HeightOffset>());
  const ModelReport rows = aiding();
  EXPECT_GT(rows.rows_used, 250);                      // 25 Hz for 13 s
  EXPECT_NEAR(rows.nis / rows.rows_used, 0.92, 0.25);  // of a gate of 99 %, three sigmas of 300
}

TEST(Trial, StartsWhereTheScenarioSays) {
  sim::Scenario s = short_scenario(3);
  s.errors.start_velocity = {2.0, 2.0, 0.0};
  s.errors.start_velocity_sigma = 2.0;
  const sim::Flight flight = sim::simulate_flight(s);
  const Trial trial = fly(flight, options_for(flight, "default"));
  // started at the first sample, so that the first scan is processed
  ASSERT_EQ(trial.steps.front().estimate.time, flight.scans.front().time);
  EXPECT_GT(trial.steps.front().covariance(body::kGyroBias, body::kGyroBias), 1e-6);
  EXPECT_LT((trial.steps.back().estimate.v_WB - trial.steps.back().truth.v_WB).norm(), 0.2);
}

TEST(Trial, IsIncompleteAfterASilenceOfTheFilterAndNotOfTheRadar) {
  sim::Scenario s = short_scenario(5);
  s.disturbances.outages = {1, 5.0};
  sim::Flight flight = sim::simulate_flight(s);
  EXPECT_TRUE(fly(flight, options_for(flight, "default")).complete);
  flight = sim::simulate_flight(short_scenario(5));
  flight.scans.resize(flight.scans.size() / 2);
  flight.arrivals.resize(flight.scans.size());
  EXPECT_FALSE(fly(flight, options_for(flight, "default")).complete);
}

TEST(Columns, CompareRunsOfTheSameFlights) {
  Scores a(2);
  Scores b(2);
  a[0].ape = 5.0;
  a[1].ape = 1.0;
  b[0].ape = 5.5;
  b[1].ape = 1.7;
  b[1].lost = true;
  b[0].nees_position = b[1].nees_position = 1.25;
  // differences 0.5 and 0.7: their deviation 0.141, that of the mean 0.1
  const std::vector<Column> columns = {spread_of("x", &Score::ape, 1), mean_of("y", &Score::ape, 1),
                                       change_of("z", &Score::ape, 2), nees_of("n", 2),
                                       lost_of("lost")};
  EXPECT_EQ(row_of({"b"}, columns, b, a),
            (std::vector<std::string>{"b", "3.6 (5.5) ± 2.7", "3.6", "+0.60 ± 0.10",
                                      "1.25 / 0.00 / 0.00", "1"}));
  EXPECT_EQ(head_of({"of"}, columns), (std::vector<std::string>{"of", "x", "y", "z", "n", "lost"}));
}

TEST(Score, OfAKnownError) {
  Trial trial;
  trial.complete = true;
  for (int i = 0; i <= 100; ++i) {
    Step step;
    step.truth.time = step.estimate.time = from_seconds(0.1 * i);
    step.truth.p_WB = {0.1 * i, 0.0, 0.0};
    step.estimate = step.truth;
    step.estimate.p_WB.y() += 0.02 * i;  // 2 m in the end: 20 % of 10 m
    step.estimate.v_WB = step.truth.v_WB + Vector3d(0.0, 0.2, 0.0);
    step.covariance = BodyCovariance::Identity() * 0.04;
    trial.steps.push_back(step);
  }
  Score s = score(trial);
  EXPECT_NEAR(s.path_length, 10.0, 1e-9);
  EXPECT_NEAR(s.final_error, 2.0, 1e-9);
  EXPECT_NEAR(s.drift, 20.0, 1e-6);
  EXPECT_NEAR(s.mae, 1.0, 1e-9);
  EXPECT_NEAR(s.ape, 0.02 * std::sqrt(338'350.0 / 101.0), 1e-9);  // 1^2 + ... + 100^2
  EXPECT_NEAR(s.velocity, 0.2, 1e-9);
  EXPECT_NEAR(s.nees_velocity, 1.0 / 3.0, 1e-9);
  EXPECT_NEAR(s.heading, 0.0, 1e-9);
  EXPECT_FALSE(s.lost);  // 2 m are allowed
  trial.steps.back().estimate.p_WB.y() += 0.01;
  EXPECT_TRUE(score(trial).lost);
  trial.steps.back().estimate.p_WB.y() = std::nan("");
  EXPECT_TRUE(score(trial).lost);
  EXPECT_TRUE(score(Trial{}).lost);
  EXPECT_TRUE(std::isnan(score(Trial{}).ape));
}

}  // namespace
}  // namespace rio::experiment

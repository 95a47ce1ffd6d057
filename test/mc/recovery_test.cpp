// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights whose velocity is told wrongly, and flights in which nothing is wrong.
#include <gtest/gtest.h>

#include "experiment/campaign.hpp"

namespace rio::experiment {
namespace {

const std::vector<Variant> kDefault = {{"default", "default"}};

// Largest error of the velocity later than one second after the start.
double late_error(const Trial& trial) {
  double largest = 0.0;
  const Time start = trial.steps.front().truth.time;
  for (const Step& step : trial.steps) {
    if (to_seconds(step.truth.time - start) < 1.0) continue;
    largest = std::max(largest, (step.estimate.v_WB - step.truth.v_WB).norm());
  }
  return largest;
}

std::vector<Case> short_cases(const std::string& name, int count) {
  std::vector<Case> cases = cases_of(name, count);
  for (Case& c : cases) c.scenario.path.length = 10.0;
  return cases;
}

TEST(Recovery, FromAWrongVelocityWithinASecond) {
  int flights = 0;
  run_campaign(short_cases("wrong-velocity", 12), kDefault, {},
               [&](const Case& c, const Variant&, const Trial& trial) {
                 ++flights;
                 EXPECT_LT(late_error(trial), 0.2) << c.scenario.seed;
                 EXPECT_EQ(trial.counters.velocity_resets, 1U) << c.scenario.seed;
                 EXPECT_FALSE(score(trial).lost) << c.scenario.seed;
               });
  EXPECT_EQ(flights, 12);
}

TEST(Recovery, AnHonestSigmaNeedsNone) {
  run_campaign(short_cases("vague-velocity", 4), kDefault, {},
               [](const Case& c, const Variant&, const Trial& trial) {
                 EXPECT_LT(late_error(trial), 0.2) << c.scenario.seed;
                 EXPECT_EQ(trial.counters.velocity_resets, 0U) << c.scenario.seed;
               });
}

TEST(Recovery, NoFalseAlarm) {
  std::vector<Case> cases;
  for (const char* name : {"indoor-1", "storm", "dropout", "people", "aggressive", "hover"}) {
    cases.push_back(cases_of(name, 1, 21).front());
  }
  run_campaign(cases, kDefault, {}, [](const Case& c, const Variant&, const Trial& trial) {
    EXPECT_EQ(trial.counters.velocity_resets, 0U) << c.group;
    EXPECT_TRUE(trial.complete) << c.group;
  });
}

}  // namespace
}  // namespace rio::experiment

// SPDX-License-Identifier: BSD-3-Clause
// The seven indoor flights with realistic sensors, once each: the default preset stays within its
// bounds and ahead of the published filter. `rio experiment icra2023` has more flights and figures.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/spread.hpp"
#include "rio/sim/catalogue.hpp"
#include "support/measured.hpp"

namespace rio::experiment {
namespace {

TEST(Accuracy, SevenFlightsWithBothPresets) {
  std::vector<Case> cases;
  for (std::size_t i = 1; i <= sim::kIcraLengths.size(); ++i) {
    cases.push_back(cases_of("indoor-" + std::to_string(i), 1, 100 + i).front());
  }
  const std::vector<Outcome> runs = run_campaign(cases, presets_compared(), {});
  const std::vector<Score> standard = select(runs, "indoor", "default");
  const std::vector<Score> published = select(runs, "indoor", "published-ekf");
  ASSERT_EQ(standard.size(), 7U);
  ASSERT_EQ(published.size(), 7U);
  EXPECT_EQ(count_lost(standard), 0);
  EXPECT_EQ(count_lost(published), 0);
  const auto mean = [](const std::vector<Score>& scores, double Score::*value) {
    return Spread::of(scores, value).mean;
  };
  for (const auto value : {&Score::drift, &Score::mae}) {
    const std::string what = value == &Score::drift ? ": drift [%]" : ": norm of MAE [m]";
    test::expect_below("default" + what, mean(standard, value), 0.5);
    test::measured("published-ekf" + what, mean(published, value), "above default");
  }
  for (const auto value : {&Score::drift, &Score::mae, &Score::heading, &Score::velocity}) {
    EXPECT_LT(mean(standard, value), mean(published, value));
  }
}

}  // namespace
}  // namespace rio::experiment

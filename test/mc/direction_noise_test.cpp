// SPDX-License-Identifier: BSD-3-Clause
// What badly measured elevations cost: the drift at 8 deg of elevation noise over the drift at
// 0.6 deg, same seeds. A filter that takes directions as exact pays with its velocity, which
// shrinks along badly measured angles (errors in variables, models/doppler.hpp).
#include <gtest/gtest.h>

#include <vector>

#include "experiment/campaign.hpp"
#include "experiment/spread.hpp"
#include "rio/sim/radar_model.hpp"

namespace rio::experiment {
namespace {

constexpr int kFlights = 8;
constexpr double kFine = 0.6 * kDegree;
constexpr double kCoarse = 8.0 * kDegree;

const std::vector<Variant> kDirections = {
    {"default", "default"}, {"naive", "default", [](Options& o) {
                               o.update.use_landmarks =
                                   false;  // they average the directions of many scans
                               o.update.doppler_directions = DopplerDirections::kExact;
                               o.checks.biases = false;  // takes the shrunk velocity for a drift
                             }}};

std::vector<Case> flights(const char* group, double sigma_elevation) {
  std::vector<Case> cases = cases_of("monte-carlo", kFlights, 401);
  for (Case& c : cases) {
    c.group = group;
    c.scenario.path.length = 60.0;
    c.scenario.radar.sigma_elevation = sigma_elevation;  // the filter is told
  }
  return cases;
}

TEST(DirectionNoise, CostsTheDefaultLittle) {
  std::vector<Case> cases = flights("fine", kFine);
  for (const Case& c : flights("coarse", kCoarse)) cases.push_back(c);
  const std::vector<Outcome> runs = run_campaign(cases, kDirections, {});
  const auto cost = [&](const char* variant) {
    const std::vector<Score> fine = select(runs, "fine", variant);
    const std::vector<Score> coarse = select(runs, "coarse", variant);
    EXPECT_EQ(count_lost(fine), 0) << variant;
    // the naive one may lose a coarse flight: one of these eight
    EXPECT_LE(count_lost(coarse), std::string(variant) == "default" ? 0 : 1) << variant;
    return Spread::of(coarse, &Score::drift).mean / Spread::of(fine, &Score::drift).mean;
  };
  EXPECT_LT(cost("default"), 3.0);  // measured: 2.5 to 2.6
  EXPECT_GT(cost("naive"), 6.0);    // measured: 7 to 8, from 0.2 to 1.5 % of the path
}

/// Twice what is true of the elevation, and found in flight or not (frontend/direction_noise.hpp).
TEST(DirectionNoise, AnElevationToldTwiceTooNoisyIsFound) {
  const Variants told = {{"right", "default"},
                         {"twice", "default", [](Options& o) { o.radar.sigma_elevation *= 2.0; }},
                         {"not found", "default", [](Options& o) {
                            o.radar.sigma_elevation *= 2.0;
                            o.ablation.direction_noise = false;
                          }}};
  const std::vector<Outcome> runs = run_campaign(cases_of("indoor-1", 4, 421), told, {});
  const auto error = [&](const char* variant) {
    return Spread::of(select(runs, "indoor-1", variant), &Score::ape).mean;
  };
  EXPECT_LT(error("twice"), 1.5 * error("right"));      // measured: 0.84
  EXPECT_GT(error("not found"), 2.0 * error("right"));  // measured: 2.5
}

}  // namespace
}  // namespace rio::experiment

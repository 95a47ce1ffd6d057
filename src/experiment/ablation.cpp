// SPDX-License-Identifier: BSD-3-Clause
// The default preset with one mechanism off at a time: what does each bring, and where?
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/spread.hpp"
#include "rio/sim/catalogue.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 20;
const std::vector<std::string> kFamilies = {"indoor", "extrinsics", "wrong-velocity", "aggressive",
                                            "people", "outdoor",    "hover"};

std::vector<Variant> variants() {
  return {
      {"default", "default"},
      {"no direction correction in Doppler", "default",
       [](Options& o) { o.update.direction_correction = false; }},
      {"no direction noise in Doppler", "default",
       [](Options& o) { o.update.direction_noise = false; }},
      {"neither of the two", "default",
       [](Options& o) { o.update.direction_correction = o.update.direction_noise = false; }},
      {"covariance not re-expressed", "default",
       [](Options& o) { o.update.consistent_covariance = false; }},
      {"extrinsics not estimated", "default",
       [](Options& o) {
         o.update.extrinsic_rotation_sigma = o.update.extrinsic_translation_sigma = 0.0;
       }},
      {"RANSAC without prediction", "default",
       [](Options& o) { o.frontend.ransac_use_prediction = false; }},
      {"RANSAC with a constant bound", "default",
       [](Options& o) { o.frontend.ransac_sigmas = 0.0; }},
      {"Doppler not unwrapped", "default", [](Options& o) { o.frontend.unwrap_doppler = false; }},
      {"no recovery of the velocity", "default",
       [](Options& o) { o.frontend.velocity_recovery = false; }},
      {"Euclidean matching", "default",
       [](Options& o) { o.frontend.matching = Matching::kEuclidean; }},
      {"ambiguous matches used", "default", [](Options& o) { o.frontend.match_margin = 0.0; }},
      {"landmarks dropped at the first miss", "default",
       [](Options& o) { o.frontend.landmark_timeout = 0.0; }},
      {"landmarks do not walk", "default", [](Options& o) { o.update.landmark_walk = 0.0; }},
      {"landmarks by distance", "default",
       [](Options& o) {
         o.update.landmark_measurement = LandmarkMeasurement::kDistance;
         o.update.landmark_walk = 0.0;
       }},
      {"trails and landmarks by distance", "default",
       [](Options& o) {
         o.update.landmark_measurement = LandmarkMeasurement::kDistance;
         o.update.landmark_walk = 0.0;
         o.update.use_trails = true;
         o.update.max_clones = 7;
       }},
      {"no landmarks: Doppler alone", "default",
       [](Options& o) { o.update.use_landmarks = false; }},
      {"no Doppler", "default", [](Options& o) { o.update.use_doppler = false; }},
  };
}

/// Flights of a family; "indoor" goes through the seven lengths.
std::vector<Case> family(const std::string& name, int count) {
  if (name != "indoor") return cases_of(name, count);
  std::vector<Case> cases;
  for (int i = 0; i < count; ++i) {
    const int flight = i % static_cast<int>(sim::kIcraLengths.size());
    Case c = cases_of(fmt::format("indoor-{}", flight + 1), 1, static_cast<std::uint64_t>(i) + 1)
                 .front();
    c.group = name;
    cases.push_back(c);
  }
  return cases;
}

/// Mean difference of two lists of paired runs and its standard error.
std::string difference(const std::vector<Score>& with, const std::vector<Score>& without,
                       double Score::*value) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < with.size(); ++i) {
    differences.push_back(without[i].*value - with[i].*value);
  }
  const Spread s = Spread::of(differences);
  const double error = s.std / std::sqrt(static_cast<double>(differences.size()));
  return fmt::format("{:+.3f} ± {:.3f}", s.mean, error);
}

}  // namespace

Result ablation(const Settings& settings) {
  std::vector<Case> cases;
  for (const std::string& name : kFamilies) {
    for (Case& c : family(name, settings.seeds > 0 ? settings.seeds : kSeeds)) cases.push_back(c);
  }
  const std::vector<Outcome> runs = run_campaign(cases, variants(), settings);

  Result result;
  result.markdown =
      "Mean (worst) ± standard deviation over the flights. Change: mean difference to `default` in "
      "the same flights ±\nits standard error; above zero the mechanism helps.\n";
  for (const std::string& name : kFamilies) {
    const std::vector<Score> reference = select(runs, name, "default");
    MarkdownTable table({fmt::format("{} ({} flights)", name, reference.size()), "final error [m]",
                         "change [m]", "norm of MAE [m]", "change [m]", "heading [deg]",
                         "NEES position / heading / velocity", "lost"});
    for (const Variant& variant : variants()) {
      const std::vector<Score> scores = select(runs, name, variant.name);
      const auto mean = [&](double Score::*value) {
        return number(Spread::of(scores, value).mean, 2);
      };
      table.add({variant.name, Spread::of(scores, &Score::final_error).text(2),
                 difference(reference, scores, &Score::final_error),
                 Spread::of(scores, &Score::mae).text(2),
                 difference(reference, scores, &Score::mae), mean(&Score::heading),
                 mean(&Score::nees_position) + " / " + mean(&Score::nees_heading) + " / " +
                     mean(&Score::nees_velocity),
                 fmt::format("{}", count_lost(scores))});
    }
    result.markdown += "\n" + table.text();
  }
  result.attachments.push_back({"ablation.csv", outcomes_as_csv(runs)});
  return result;
}

}  // namespace rio::experiment

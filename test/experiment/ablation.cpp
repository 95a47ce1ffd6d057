// SPDX-License-Identifier: BSD-3-Clause
// The default preset with one mechanism off at a time: the effect of each, by scenario.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "rio/sim/catalogue.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 14;  // twice the seven lengths

/// One mechanism switched off, or on if it is off by default. Flown with all recordings, and where
/// it should matter.
struct Switch {
  const char* name;
  const char* families;  ///< separated by spaces
  Change change;
};

const std::vector<Switch>& switches() {
  static const std::vector<Switch> all = {
      {"directions in the Doppler exact", "indoor hover",
       [](Options& o) { o.update.doppler_directions = DopplerDirections::kExact; }},
      {"directions in the Doppler noisy, not corrected", "indoor hover",
       [](Options& o) { o.update.doppler_directions = DopplerDirections::kNoisy; }},
      {"weak echoes as good as strong ones", "outdoor",
       [](Options& o) { o.radar.weak_snr_db = -200.0; }},
      {"errors new in every scan", "hover", [](Options& o) { o.radar.noise_distance = 0.0; }},
      {"stamps of the IMU exact", "rough-imu", [](Options& o) { o.imu.stamp_sigma = 0.0; }},
      {"covariance not re-expressed", "outdoor",
       [](Options& o) { o.update.consistent_covariance = false; }},
      {"mounting not estimated", "extrinsics",
       [](Options& o) { o.calibration.rotation_sigma = o.calibration.translation_sigma = 0.0; }},
      {"mounting unknown", "people sparse outdoor hover", forget_mounting},
      {"time offset not estimated", "late-stamps",
       [](Options& o) { o.calibration.time_offset_sigma = 0.0; }},
      {"Doppler scale not estimated", "miscalibrated",
       [](Options& o) { o.calibration.doppler_scale_sigma = 0.0; }},
      {"RANSAC without prediction", "people sparse",
       [](Options& o) { o.frontend.ransac_use_prediction = false; }},
      {"RANSAC with a constant bound", "people sparse",
       [](Options& o) { o.frontend.ransac_sigmas = 0.0; }},
      {"slow movers not sought", "people sparse",
       [](Options& o) { o.frontend.mover_sigmas = 0.0; }},
      {"what is near to a mover used", "people", [](Options& o) { o.frontend.mover_extent = 0.0; }},
      {"echoes of the vehicle used", "rough-ground",
       [](Options& o) { o.frontend.own_echoes = false; }},
      {"rest not used", "hover", [](Options& o) { o.frontend.detect_rest = false; }},
      {"Doppler not unwrapped", "aggressive",
       [](Options& o) { o.frontend.unwrap_doppler = false; }},
      {"no check of the landmarks", "hover", [](Options& o) { o.checks.landmarks = false; }},
      {"no check of the velocity", "wrong-velocity", [](Options& o) { o.checks.velocity = false; }},
      {"no check of the tilt", "wrong-velocity", [](Options& o) { o.checks.tilt = false; }},
      {"no check of the heading", "", [](Options& o) { o.checks.heading = false; }},
      {"no check of the biases", "", [](Options& o) { o.checks.biases = false; }},
      {"no check of the position", "people", [](Options& o) { o.checks.position = false; }},
      {"no restart of a lost tilt", "wrong-velocity",
       [](Options& o) { o.checks.lost_tilt = false; }},
      {"noise of the IMU as declared", "rough-imu",
       [](Options& o) { o.imu.measure_noise = false; }},
      {"calibration at the predicted motion", "extrinsics",
       [](Options& o) { o.ablation.steady_motion = false; }},
      {"Dopplers of a scan independent of the gyro sample", "rough-imu",
       [](Options& o) { o.ablation.shared_gyro_noise = false; }},
      {"directions as noisy as told", "hover outdoor",
       [](Options& o) { o.ablation.direction_noise = false; }},
      {"directions of landmarks new in every look", "hover",
       [](Options& o) { o.ablation.look_correlation = false; }},
      {"heights of landmarks do not walk", "hover rough-ground",
       [](Options& o) { o.ablation.elevation_walk = false; }},
      {"elevations of landmarks without a common error", "hover rough-ground",
       [](Options& o) { o.calibration.elevation_sigma = 0.0; }},
      {"range of landmarks of first order", "hover",
       [](Options& o) { o.ablation.range_curvature = false; }},
      {"Doppler of a wrong match as good as of a right one", "hover",
       [](Options& o) { o.ablation.mismatch_doppler = false; }},
      {"matches of the gate at once", "hover",
       [](Options& o) { o.frontend.match_core = o.frontend.match_probability; }},
      {"Euclidean matching", "indoor people",
       [](Options& o) { o.frontend.matching = Matching::kEuclidean; }},
      {"ambiguous matches used", "hover sparse", [](Options& o) { o.frontend.match_margin = 0.0; }},
      {"RANSAC bound, slow movers and margin off", "hover people sparse",
       [](Options& o) {
         o.frontend.ransac_sigmas = o.frontend.mover_sigmas = o.frontend.match_margin = 0.0;
       }},
      {"every match taken for right", "indoor hover",
       [](Options& o) { o.update.match_trust = 1.0; }},
      {"landmarks dropped at the first miss", "indoor hover",
       [](Options& o) { o.frontend.landmark_timeout = 0.0; }},
      {"landmarks do not walk", "indoor hover", [](Options& o) { o.update.landmark_walk = 0.0; }},
      {"landmarks by distance", "indoor",
       [](Options& o) {
         o.update.landmark_measurement = LandmarkMeasurement::kDistance;
         o.update.landmark_walk = 0.0;
       }},
      {"trails and landmarks by distance", "indoor",
       [](Options& o) {
         o.update.landmark_measurement = LandmarkMeasurement::kDistance;
         o.update.landmark_walk = 0.0;
         o.update.use_trails = true;
         o.update.max_clones = 7;
       }},
      {"no landmarks: Doppler alone", "indoor hover",
       [](Options& o) { o.update.use_landmarks = false; }},
      {"no Doppler", "indoor", [](Options& o) { o.update.use_doppler = false; }},
  };
  return all;
}

constexpr std::array kFamilies = {"indoor",        "hover",        "outdoor",    "rough-imu",
                                  "extrinsics",    "people",       "sparse",     "late-stamps",
                                  "miscalibrated", "rough-ground", "aggressive", "wrong-velocity"};

/// The default and the switches of a family, or all.
Variants variants_of(std::string_view family = "") {
  Variants variants = {{"default", "default"}};
  for (const Switch& s : switches()) {
    if (std::string_view(s.families).find(family) == std::string_view::npos) continue;
    variants.push_back({s.name, "default", s.change});
  }
  return variants;
}

/// Flights of a family; "indoor" covers the seven lengths.
Cases family(const std::string& name, int count) {
  if (name != "indoor") return cases_of(name, count);
  Cases cases;
  for (int i = 0; i < count; ++i) {
    const int flight = i % static_cast<int>(sim::kIcraLengths.size());
    const auto seed = static_cast<std::uint64_t>(i) + 1;
    cases.push_back(cases_of(fmt::format("indoor-{}", flight + 1), 1, seed).front());
  }
  return cases;
}

}  // namespace

Result ablation_real(const Settings& settings) {
  constexpr int kRealSeeds = 8;
  if (settings.data.empty()) throw std::runtime_error("ablation-real needs --data, as real does");
  std::vector<Recording> recordings = find_recordings(settings.data);
  std::erase_if(recordings, [](const Recording& r) { return r.group == "car"; });
  const Variants variants = variants_of();
  const int seeds = settings.seeds_or(kRealSeeds);
  const std::vector<RealRun> runs = replay_campaign(recordings, variants, seeds, settings);
  /// Means over the seeds of a recording, then over recordings: seeds are no independent drives.
  const auto change = [&](std::size_t variant, const auto& value) -> std::string {
    if (variant == 0) return "-";
    std::vector<double> of_recordings;
    for (std::size_t first = 0; first < runs.size(); first += variants.size()) {
      double sum = 0.0;
      for (std::size_t k = 0; k < runs[first].scores.size(); ++k) {
        sum += std::invoke(value, runs[first + variant].scores[k]) -
               std::invoke(value, runs[first].scores[k]);
      }
      if (std::isfinite(sum)) of_recordings.push_back(sum / seeds);
    }
    return mean_with_error(of_recordings, 2);
  };
  const auto square = [](const RealScore& s) { return s.sigmas_median * s.sigmas_median; };
  MarkdownTable table({"recordings", "horizontal [% of the distance]", "height [%]", "closure [m]",
                       "square of height error / sigma, 2nd half", "honest"});
  for (std::size_t v = 0; v < variants.size(); ++v) {
    int honest = 0;
    for (const RealRun& run : runs) {
      for (const RealScore& s : run.scores) honest += run.variant == v && s.honest >= 0.95 ? 1 : 0;
    }
    table.add(
        {variants[v].name, change(v, &RealScore::horizontal_share),
         change(v, &RealScore::height_share), change(v, &RealScore::closure), change(v, square),
         fmt::format("{} of {}", honest, recordings.size() * static_cast<std::size_t>(seeds))});
  }
  return {fmt::format(
      "Real recordings, filter, each with every seed: mean change ± standard error over the\n"
      "recordings when a mechanism is switched off; above zero it helps. Honest: zero height\n"
      "within 3 sigma in 95 % of the scans.\n\n{}",
      table.text())};
}

Result ablation(const Settings& settings) {
  const std::vector<Column> columns = {spread_of("final error [m]", &Score::final_error, 2),
                                       change_of("change [m]", &Score::final_error, 3),
                                       spread_of("norm of MAE [m]", &Score::mae, 2),
                                       change_of("change [m]", &Score::mae, 3),
                                       mean_of("heading [deg]", &Score::heading, 2),
                                       nees_of("NEES position / heading / velocity", 2),
                                       lost_of("lost")};
  Outcomes all;
  std::string markdown =
      "Mean (worst) ± standard deviation over the flights. Change: mean difference to `default` in "
      "the same flights ±\nits standard error; above zero the mechanism helps.\n";
  for (const std::string name : kFamilies) {
    const Cases cases = family(name, settings.seeds_or(kSeeds));
    const Variants variants = variants_of(name);
    const Outcomes runs = run_campaign(cases, variants, settings);
    all.insert(all.end(), runs.begin(), runs.end());
    MarkdownTable table(head_of({fmt::format("{} ({} flights)", name, cases.size())}, columns));
    for (const Variant& v : variants) {
      table.add(
          row_of({v.name}, columns, select(runs, name, v.name), select(runs, name, "default")));
    }
    markdown += "\n" + table.text();
  }
  return {markdown, {{"ablation.csv", outcomes_as_csv(all)}}};
}

}  // namespace rio::experiment

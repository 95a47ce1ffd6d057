// SPDX-License-Identifier: BSD-3-Clause
// Michalczyk et al., ICRA 2023, on simulated flights of the same lengths: Table I (norm of MAE at
// 127 m and final drift), Fig. 6 (norm of MAE over the distance), the contribution of each kind of
// measurement, and Table II (time per scan).
#include <fmt/format.h>

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/figures.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/models/aids.hpp"
#include "rio/sim/catalogue.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 5;      // of each of the seven flights
constexpr double kStep = 5.0;  // of the curve over the distance [m]

/// As published, Table I.
struct Published {
  double mae;    ///< at 127 m [m]
  double drift;  ///< [%]
};
constexpr std::array kTableOne = {Published{0.90, 0.17}, Published{1.10, 1.62},
                                  Published{0.68, 0.80}, Published{0.71, 0.61},
                                  Published{0.59, 0.78}, Published{0.84, 0.91},
                                  Published{0.45, 0.81}, Published{0.75, 0.81}};  // last: average

constexpr const char* kDopplerLandmarks = "Doppler, landmarks";
constexpr const char* kDopplerOnly = "doppler-only";
/// The filter before that of 2023 (Michalczyk et al. 2022): trails of one past scan, no landmarks.
constexpr const char* kOnePastScan = "published-ekf: one past scan, Doppler, trails";

Variant measuring(const std::string& preset, const char* what, bool doppler, bool trails,
                  bool landmarks) {
  return {preset + ": " + what, preset, [=](Options& o) {
            o.update.use_doppler = doppler;
            o.update.use_trails = trails;
            o.update.use_landmarks = landmarks;
          }};
}

Variants variants() {
  Variants all = presets_compared();
  for (const std::string preset : {"default", "published-ekf"}) {
    all.push_back(measuring(preset, "Doppler", true, false, false));
    all.push_back(measuring(preset, "Doppler, trails", true, true, false));
    // that is what `default` measures
    if (preset != "default") all.push_back(measuring(preset, kDopplerLandmarks, true, false, true));
    all.push_back(measuring(preset, "trails, landmarks", false, true, true));
    if (preset != "default") continue;
    all.push_back(measuring(preset, "Doppler, trails, landmarks", true, true, true));
  }
  all.push_back({kDopplerOnly, kDopplerOnly});
  all.push_back({kOnePastScan, "published-ekf", [](Options& o) {
                   o.update.max_clones = 1;
                   o.update.use_landmarks = false;
                 }});
  all.push_back({"published-ekf: N = 10", "published-ekf",
                 [](Options& o) { o.update.max_clones = o.frontend.promote_after = 10; }});
  for (const std::string preset : {"default", kDopplerOnly}) {
    all.push_back({preset + ": all, and a barometer", preset,
                   [](Options& o) { (void)o.auxiliary.declare<HeightOffset>(); }});
  }
  return all;
}

/// Norm of MAE up to each multiple of kStep.
Curve mae_over_distance(const std::vector<eval::PosePair>& pairs) {
  const double length = eval::path_length(pairs);
  Curve curve;
  for (double d = kStep; d <= length; d += kStep) curve.push_back({d, eval::norm_of_mae(pairs, d)});
  return curve;
}

/// One flight alone on its thread.
std::string table_two() {
  MarkdownTable table(
      {"preset, flight 7", "propagation [ms]", "update [ms]", "duration [s]", "real-time factor"});
  const sim::Flight flight = sim::simulate_flight(test::scenario_named("indoor-7"));
  const double duration = flight.trajectory.duration();
  for (const Variant& variant : presets_compared()) {
    Options options = options_of(flight, variant);
    options.timing.clock = &steady_now;
    const Trial trial = fly(flight, options);
    const double scans = static_cast<double>(trial.steps.size());
    const double propagation = to_seconds(trial.propagation_time);
    const double update = to_seconds(trial.update_time);
    table.add({variant.name, fmt::format("{:.3f}", 1e3 * propagation / scans),
               fmt::format("{:.3f}", 1e3 * update / scans), fmt::format("{:.0f}", duration),
               fmt::format("{:.0f}", duration / (propagation + update))});
  }
  table.add({"Michalczyk et al. 2023, Table II (their computer)", "0.08 an IMU sample", "2.07",
             "436", "25"});
  return table.text();
}

std::string table_one(const Outcomes& runs) {
  std::vector<std::string> head = {"flight", "length [m]"};
  for (const Variant& v : presets_compared()) {
    head.push_back(v.name + ": MAE at 127 m [m]");
    head.emplace_back("drift [%]");
  }
  head.emplace_back("paper: MAE [m]");
  head.emplace_back("drift [%]");
  MarkdownTable table(head);
  const std::vector<Column> columns = {spread_of("", &Score::mae_at_127, 2),
                                       spread_of("", &Score::drift, 2)};
  for (std::size_t i = 0; i < kTableOne.size(); ++i) {
    const bool one = i < sim::kIcraLengths.size();
    std::vector<std::string> row = {"all", ""};
    if (one) row = {fmt::format("{}", i + 1), number(sim::kIcraLengths[i], 1)};
    const std::string group = one ? fmt::format("indoor-{}", i + 1) : "";
    for (const Variant& v : presets_compared()) {
      row = row_of(std::move(row), columns, select(runs, group, v.name));
    }
    row.push_back(number(kTableOne[i].mae, 2));
    row.push_back(number(kTableOne[i].drift, 2));
    table.add(row);
  }
  return table.text();
}

std::string contributions(const Outcomes& runs) {
  const Column lost = {"lost", [](const Scores& scores, const Scores&) {
                         return fmt::format("{} of {}", count_lost(scores), scores.size());
                       }};
  const std::vector<Column> columns = {spread_of("drift [%]", &Score::drift, 2),
                                       spread_of("norm of MAE [m]", &Score::mae, 2),
                                       spread_of("heading [deg]", &Score::heading, 1), lost};
  MarkdownTable table(head_of({"measurements"}, columns));
  for (const Variant& v : variants()) {
    if (v.name == "default: trails, landmarks") {
      table.add(row_of({std::string("default: ") + kDopplerLandmarks}, columns,
                       select(runs, "", "default")));
    }
    table.add(row_of({v.change ? v.name : v.name + ": all"}, columns, select(runs, "", v.name)));
  }
  return table.text();
}

std::string chart(const std::map<std::string, std::vector<Curve>>& curves) {
  plot::Panel p = panel("Norm of MAE, mean and one standard deviation over the flights",
                        "distance flown [m]", "norm of MAE [m]");
  p.from_zero = true;
  for (const char* name : {"default", "published-ekf", kOnePastScan, kDopplerOnly}) {
    add_mean_curve(curves.at(name), name, &p);
  }
  return plot::draw_chart("Error over the distance flown", {p}, 1);
}

}  // namespace

Result icra2023(const Settings& settings) {
  const int count = settings.seeds_or(kSeeds);
  const Cases cases = indoor_cases(count);
  std::map<std::string, std::vector<Curve>> curves;
  FlownFlights flown = {{"indoor-7", {"default", "published-ekf"}}};
  const Outcomes runs = run_campaign(
      cases, variants(), settings, [&](const Case& c, const Variant& v, const Trial& trial) {
        keep(c, v, trial, &flown);
        if (v.change && v.name != kOnePastScan) return;
        curves[v.name].push_back(mae_over_distance(pose_pairs(trial)));
      });
  const std::string text = fmt::format(
      "Simulated flights of the published lengths, {} of each: mean (worst) ± standard deviation. "
      "The paper's own\nfigures, from seven real flights, stand beside them for orientation: the "
      "flights are not the same.\n\n{}\nWhat each kind of measurement contributes, all {} "
      "flights (one past scan: as in the paper's predecessor; doppler-only: as in the other method "
      "it is compared with,\nwhich has a barometer: here heights of 0.1 m at 25 Hz over a zero "
      "that "
      "walks):\n\n{}\nTime per scan:\n\n{}",
      count, table_one(runs), cases.size(), contributions(runs), table_two());
  return {
      text,
      {{"icra2023.csv", outcomes_as_csv(runs)},
       {"icra2023.svg", chart(curves)},
       {"icra2023-path.svg", chart_of_paths("A flight of 175 m", flown)},
       {"icra2023-errors.svg", chart_of_errors("Errors of position and their bounds", flown[0])}}};
}

}  // namespace rio::experiment

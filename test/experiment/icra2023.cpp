// SPDX-License-Identifier: BSD-3-Clause
// Michalczyk et al., ICRA 2023, on simulated flights of the same lengths: Table I (norm of MAE at
// 127 m and final drift), Fig. 6 (norm of MAE over the distance), the contribution of each kind of
// measurement, the radars for which trails and landmarks help, and Table II (time per scan).
#include <fmt/format.h>

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/figures.hpp"
#include "experiment/spread.hpp"
#include "experiment/trail_gain.hpp"
#include "plot/chart.hpp"
#include "plot/colours.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/sim/catalogue.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 5;  // of each of the seven flights
constexpr double kMaeDistance = 127.0;
constexpr double kStep = 5.0;  // of the curve over the distance [m]

/// As published, Table I.
struct Published {
  double mae;    ///< at 127 m [m]
  double drift;  ///< [%]
};
constexpr std::array<Published, 7> kTableOne = {
    Published{0.90, 0.17}, Published{1.10, 1.62}, Published{0.68, 0.80}, Published{0.71, 0.61},
    Published{0.59, 0.78}, Published{0.84, 0.91}, Published{0.45, 0.81}};
constexpr Published kTableOneAverage = {0.75, 0.81};

constexpr const char* kDopplerOnly = "doppler-only";

std::vector<Variant> variants() {
  std::vector<Variant> all = presets_compared();
  for (const char* preset : {"default", "published-ekf"}) {
    const auto add = [&](const char* what, bool doppler, bool trails, bool landmarks) {
      all.push_back({fmt::format("{}: {}", preset, what), preset, [=](Options& o) {
                       o.update.use_doppler = doppler;
                       o.update.use_trails = trails;
                       o.update.use_landmarks = landmarks;
                     }});
    };
    add("Doppler", true, false, false);
    add("Doppler, trails", true, true, false);
    add("Doppler, landmarks", true, false, true);
    add("trails, landmarks", false, true, true);
    if (std::string(preset) == "default") add("Doppler, trails, landmarks", true, true, true);
  }
  all.push_back({kDopplerOnly, kDopplerOnly});
  for (Variant& v : clone_variants()) {
    if (v.name != "published-ekf: N = 7") all.push_back(std::move(v));  // the preset itself
  }
  return all;
}

/// Norm of MAE up to each multiple of kStep, a vector per run.
using Curves = std::vector<std::vector<double>>;

std::vector<double> mae_over_distance(const std::vector<eval::PosePair>& pairs) {
  const double length = eval::path_length(pairs);
  std::vector<double> curve;
  for (double d = kStep; d <= length; d += kStep) curve.push_back(eval::norm_of_mae(pairs, d));
  return curve;
}

/// Mean and one standard deviation over the runs that flew at least as far.
void add_to_chart(const Curves& curves, const std::string& name, const plot::Stroke& stroke,
                  plot::Panel* panel) {
  plot::Curve mean{name, {}, stroke};
  plot::Band band;
  band.colour = stroke.colour;
  for (std::size_t i = 0;; ++i) {
    std::vector<double> values;
    for (const auto& curve : curves) {
      if (i < curve.size()) values.push_back(curve[i]);
    }
    if (values.size() < 2) break;
    const Spread s = Spread::of(values);
    const double distance = kStep * static_cast<double>(i + 1);
    mean.points.push_back({distance, s.mean});
    band.x.push_back(distance);
    band.low.push_back(s.mean - s.std);
    band.high.push_back(s.mean + s.std);
  }
  panel->curves.push_back(std::move(mean));
  panel->bands.push_back(std::move(band));
}

/// One flight alone on its thread.
std::string table_two() {
  MarkdownTable table(
      {"preset, flight 7", "propagation [ms]", "update [ms]", "duration [s]", "real-time factor"});
  const Case c = cases_of("indoor-7", 1).front();
  const sim::Flight flight = sim::simulate_flight(c.scenario);
  const double duration = flight.trajectory.duration();
  for (const Variant& variant : presets_compared()) {
    Options options = options_for(flight, variant.preset);
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

/// Norm of MAE at 127 m of the runs of a flight and a variant.
using MaeAt127 = std::map<std::pair<std::string, std::string>, std::vector<double>>;

std::string flight_name(std::size_t i) {
  return fmt::format("indoor-{}", i + 1);
}

std::string table_one(const std::vector<Outcome>& runs, const MaeAt127& mae_at_127) {
  std::vector<std::string> head = {"flight", "length [m]"};
  for (const Variant& v : presets_compared()) {
    head.push_back(v.name + ": MAE at 127 m [m]");
    head.emplace_back("drift [%]");
  }
  head.emplace_back("paper: MAE [m]");
  head.emplace_back("drift [%]");
  MarkdownTable table(head);
  std::map<std::string, std::vector<double>> mae;
  std::map<std::string, std::vector<double>> drift;
  for (std::size_t i = 0; i < sim::kIcraLengths.size(); ++i) {
    std::vector<std::string> row = {fmt::format("{}", i + 1), number(sim::kIcraLengths[i], 1)};
    for (const Variant& v : presets_compared()) {
      const std::vector<double>& values = mae_at_127.at({flight_name(i), v.name});
      mae[v.name].insert(mae[v.name].end(), values.begin(), values.end());
      row.push_back(Spread::of(values).text(2));
      const std::vector<Score> scores = select(runs, flight_name(i), v.name);
      for (const Score& s : scores) drift[v.name].push_back(s.drift);
      row.push_back(Spread::of(scores, &Score::drift).text(2));
    }
    row.push_back(number(kTableOne[i].mae, 2));
    row.push_back(number(kTableOne[i].drift, 2));
    table.add(row);
  }
  std::vector<std::string> row = {"all", ""};
  for (const Variant& v : presets_compared()) {
    row.push_back(Spread::of(mae[v.name]).text(2));
    row.push_back(Spread::of(drift[v.name]).text(2));
  }
  row.push_back(number(kTableOneAverage.mae, 2));
  row.push_back(number(kTableOneAverage.drift, 2));
  table.add(row);
  return table.text();
}

std::string contributions(const std::vector<Outcome>& runs) {
  MarkdownTable table({"measurements", "drift [%]", "norm of MAE [m]", "heading [deg]", "lost"});
  for (const Variant& variant : variants()) {
    std::vector<Score> scores;
    for (const Outcome& run : runs) {
      if (run.variant == variant.name) scores.push_back(run.score);
    }
    table.add({variant.change ? variant.name : variant.name + ": all",
               Spread::of(scores, &Score::drift).text(2), Spread::of(scores, &Score::mae).text(2),
               Spread::of(scores, &Score::heading).text(1),
               fmt::format("{} of {}", count_lost(scores), scores.size())});
  }
  return table.text();
}

std::string chart(const std::map<std::string, Curves>& curves) {
  plot::Panel panel;
  panel.title = "Norm of MAE, mean and one standard deviation over the flights";
  panel.x_label = "distance flown [m]";
  panel.y_label = "norm of MAE [m]";
  panel.from_zero = true;
  for (std::size_t k = 0; k < presets_compared().size(); ++k) {
    const std::string& name = presets_compared()[k].name;
    add_to_chart(curves.at(name), name, plot::curve_stroke(k), &panel);
  }
  const std::size_t others = presets_compared().size();
  add_to_chart(curves.at(kOnePastScan), kOnePastScan, plot::curve_stroke(others), &panel);
  add_to_chart(curves.at(kDopplerOnly), kDopplerOnly, plot::curve_stroke(others + 1), &panel);
  return plot::draw_chart("Error over the distance flown", {panel}, 1);
}

}  // namespace

Result icra2023(const Settings& settings) {
  const int count = settings.seeds > 0 ? settings.seeds : kSeeds;
  std::vector<Case> cases;
  for (std::size_t i = 0; i < sim::kIcraLengths.size(); ++i) {
    for (Case& c : cases_of(flight_name(i), count)) cases.push_back(std::move(c));
  }
  std::map<std::string, Curves> curves;
  MaeAt127 mae_at_127;
  std::vector<Outcome> runs = run_campaign(
      cases, variants(), settings, [&](const Case& c, const Variant& v, const Trial& trial) {
        if (v.change && v.name != kOnePastScan) return;
        curves[v.name].push_back(mae_over_distance(pose_pairs(trial)));
        mae_at_127[{c.group, v.name}].push_back(eval::norm_of_mae(pose_pairs(trial), kMaeDistance));
      });
  const std::string first = table_one(runs, mae_at_127);
  const std::string second = contributions(runs);
  const std::string gain = trail_gain_table(settings, &runs);
  Result result;
  result.markdown = fmt::format(
      "Simulated flights of the published lengths, {} of each: mean (worst) ± standard deviation. "
      "The paper's own\nfigures, from seven real flights, stand beside them for orientation: the "
      "flights are not the same.\n\n{}\nWhat each kind of measurement contributes, all {} "
      "flights (one past scan: as in the paper's predecessor; doppler-only: as in the other method "
      "it is compared with):\n\n{}\nWith which radar trails and "
      "landmarks pay, drift [%] / norm of MAE [m], of `published-ekf` unless said:\n\n{}\nTime per "
      "scan:\n\n{}",
      count, first, cases.size(), second, gain, table_two());
  result.attachments.push_back({"icra2023.csv", outcomes_as_csv(runs)});
  result.attachments.push_back({"icra2023.svg", chart(curves)});
  const FlownFlight flown = fly_all(cases_of("indoor-7", 1).front(), presets_compared());
  result.attachments.push_back({"icra2023-path.svg", chart_of_paths("A flight of 175 m", {flown})});
  result.attachments.push_back(
      {"icra2023-errors.svg", chart_of_errors("Errors of position and their bounds", flown)});
  return result;
}

}  // namespace rio::experiment

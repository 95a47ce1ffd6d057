// SPDX-License-Identifier: BSD-3-Clause
// Every scenario of the catalogue, one row per preset. A row states when the preset is
// overconfident, is lost, or is worse than the published filter.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.hpp"
#include "rio/eval/nees.hpp"
#include "rio/sim/catalogue.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 20;
constexpr double kLongFlight = 600.0;  // [s]; such flights are flown with a quarter of the seeds

/// Of the seven lengths indoors one: icra2023 has all.
std::vector<std::string> scenarios() {
  std::vector<std::string> names;
  for (const sim::CatalogueEntry& entry : sim::catalogue()) {
    const std::string name = entry.name;
    if (name == "indoor-1" || !name.starts_with("indoor-")) names.push_back(name);
  }
  return names;
}

Cases flights_of(const std::string& name, int seeds) {
  Cases cases = cases_of(name, seeds);
  const sim::PathOptions& path = cases.front().scenario.path;
  if (path.length <= 0.0 && path.duration >= kLongFlight) {
    cases.resize(std::max<std::size_t>(1, cases.size() / 4));
  }
  return cases;
}

/// The blocks whose mean NEES is above what 99 % of consistent filters show at one instant.
std::string overconfident_in(const Scores& scores) {
  const int runs = static_cast<int>(scores.size());
  const double three = eval::anees_bounds(3, runs, 0.99).upper / 3.0;
  const double one = eval::anees_bounds(1, runs, 0.99).upper;
  std::vector<std::string> blocks;
  // not <=, so that a NaN is reported
  const auto check = [&](const char* name, double Score::*value, double bound) {
    if (!(Spread::of(scores, value).mean <= bound)) blocks.emplace_back(name);
  };
  check("position", &Score::nees_position, three);
  check("heading", &Score::nees_heading, one);
  check("velocity", &Score::nees_velocity, three);
  return fmt::format("{}", fmt::join(blocks, ", "));
}

std::string lost_text(const Scores& scores) {
  return fmt::format("lost in {} of {}", count_lost(scores), scores.size());
}

/// Remarks on a row.
std::string remark(const Scores& scores, const Scores& published) {
  std::vector<std::string> remarks;
  if (count_lost(scores) > 0) remarks.push_back(lost_text(scores));
  const std::string blocks = overconfident_in(scores);
  if (!blocks.empty()) remarks.push_back("overconfident in " + blocks);
  const auto worse = [&](double Score::*value) {
    return Spread::of(scores, value).mean > Spread::of(published, value).mean;
  };
  if (worse(&Score::drift)) remarks.emplace_back("drifts more than published-ekf");
  if (worse(&Score::mae)) remarks.emplace_back("larger MAE than published-ekf");
  if (count_lost(published) > 0) remarks.push_back("published-ekf " + lost_text(published));
  return fmt::format("{}", fmt::join(remarks, "; "));
}

}  // namespace

Result robustness(const Settings& settings) {
  Cases cases;
  for (const std::string& name : scenarios()) {
    for (const Case& c : flights_of(name, settings.seeds_or(kSeeds))) cases.push_back(c);
  }
  // the long flights first: no thread ends alone with one
  std::stable_sort(cases.begin(), cases.end(), [](const Case& a, const Case& b) {
    return a.scenario.path.length < b.scenario.path.length;
  });
  const Outcomes runs = run_campaign(cases, presets_compared(), settings);

  std::vector<std::string> head = {"scenario", "flights"};
  const std::vector<Column> columns = {spread_of("final error [m]", &Score::final_error, 2),
                                       spread_of("drift [%]", &Score::drift, 2),
                                       spread_of("norm of MAE [m]", &Score::mae, 2),
                                       nees_of("NEES p / h / v", 1)};
  for (const Variant& v : presets_compared()) {
    const std::size_t first = head.size();
    head = head_of(std::move(head), columns);
    head[first] = v.name + ": " + head[first];
  }
  head.push_back("remark on " + presets_compared().front().name);
  MarkdownTable table(head);
  for (const std::string& name : scenarios()) {
    const Scores best = select(runs, name, "default");
    const Scores published = select(runs, name, "published-ekf");
    std::vector<std::string> row = {name, fmt::format("{}", best.size())};
    for (const Scores* scores : {&best, &published}) row = row_of(std::move(row), columns, *scores);
    row.push_back(remark(best, published));
    table.add(row);
  }
  const std::string text = fmt::format(
      "Mean (worst) ± standard deviation over the flights. NEES of position, heading and velocity: "
      "mean over flight and\nruns of the normalised estimation error squared over its dimension; 1 "
      "is right, above 1 is overconfident. Lost: ends\noff by more than 5 % of the path and 2 m. "
      "`rio scenarios` says what each scenario is.\n\n{}",
      table.text());
  return {text, {{"robustness.csv", outcomes_as_csv(runs)}}};
}

}  // namespace rio::experiment

// SPDX-License-Identifier: BSD-3-Clause
// Many trials: cases (a scenario and a seed) times variants (a preset and a change of its options).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/parallel.hpp"
#include "experiment/score.hpp"
#include "rio/sim/scenario.hpp"

namespace rio::experiment {

/// One flight.
struct Case {
  std::string group;  ///< cases of one group share the rows of a table
  sim::Scenario scenario;
};

/// `count` flights of a named scenario with seeds first, first + 1, ...
/// @throws std::runtime_error if the catalogue has no such scenario
std::vector<Case> cases_of(const std::string& name, int count, std::uint64_t first = 1);

/// One estimator.
struct Variant {
  std::string name;
  std::string preset;
  std::function<void(Options&)> change{};  ///< applied to the preset, if set
};

/// Options of the variant's preset with the sensors of the flight and its change.
Options options_of(const sim::Flight& flight, const Variant& variant);

/// One trial's result.
struct Outcome {
  std::string group;
  std::uint64_t seed = 0;
  std::string variant;
  Score score;
};

/// Settings of an experiment.
struct Settings {
  int seeds = 0;  ///< flights of a kind; 0 = the default of the experiment
  int threads = 2;
  std::string data{};     ///< folder of the recordings, for experiments on real ones
  double hours = 24.0;    ///< of flight, for `soak`
  bool smoother = false;  ///< the back-end of `soak`
  OnProgress on_progress{};
  std::string dataset{};  ///< name of the data set, for `benchmark`
};

/// Called with each trial before it is discarded, never by two threads at a time.
using EachTrial = std::function<void(const Case&, const Variant&, const Trial&)>;

/// Flies every case with every variant. Runs come by case, then by variant.
std::vector<Outcome> run_campaign(const std::vector<Case>& cases,
                                  const std::vector<Variant>& variants, const Settings& settings,
                                  const EachTrial& each = {});

/// Median time of a scan of one flight alone on its thread [ms].
double median_time_per_scan(const sim::Flight& flight, const Variant& variant);

/// The runs of one group and variant.
std::vector<Score> select(const std::vector<Outcome>& runs, std::string_view group,
                          std::string_view variant);

/// Number of lost runs.
int count_lost(const std::vector<Score>& scores);

/// All figures of all runs, a row per run.
std::string outcomes_as_csv(const std::vector<Outcome>& runs);

}  // namespace rio::experiment

// SPDX-License-Identifier: BSD-3-Clause
// The experiments: each answers one question with many simulated flights, as tables and charts.
#pragma once

#include <string>
#include <vector>

#include "experiment/campaign.hpp"

namespace rio::experiment {

/// A file an experiment writes beside its report.
struct Attachment {
  std::string name;  ///< with extension
  std::string text;
};

/// Result of an experiment.
struct Result {
  std::string markdown;  ///< tables with explanations
  std::vector<Attachment> attachments;
};

/// Table I and II of Michalczyk et al., ICRA 2023: accuracy of the seven flights, error over the
/// distance travelled, contribution of Doppler, trails and landmarks, time per scan.
Result icra2023(const Settings& settings);
/// Does the error agree with the covariance? NEES over matched runs, NIS per model.
Result consistency(const Settings& settings);
/// The default preset with one mechanism off at a time.
Result ablation(const Settings& settings);
/// Every scenario of the catalogue with every preset.
Result robustness(const Settings& settings);

/// Table I and Fig. 9 of Michalczyk et al., IROS 2024: the filter and the sliding window, accuracy,
/// convergence from a wrong velocity, time per scan; and the window's kernels under outliers.
Result iros2024(const Settings& settings);

/// Every fault of the catalogue (fault.hpp) in several flights with both back-ends: promises kept,
/// wrong final states, and which of these are reported.
Result fault_campaign(const Settings& settings);

/// Tables I to III, Fig. 7 and 8 of Xu et al.: the benefit of each point's noise as a weight and in
/// matching, its correct size, comparison of estimators, NIS, time per scan.
Result uncertainty(const Settings& settings);

/// Every real recording of a folder (Settings::data) with every preset and both back-ends, over
/// seeds of the RANSAC, also two radars together and perturbed copies: errors and honesty.
Result real(const Settings& settings);

/// Every recording below a folder (Settings::data: bags of Settings::dataset, and folders) with
/// both back-ends: ATE, RPE, final error, NEES, time, verdict; failures are rows, too.
Result benchmark(const Settings& settings);

/// Drives of Settings::data with an ideal IMU, with one cause of noise at a time, and with ideal
/// Dopplers: errors of the estimator apart from those of the sensors.
Result control(const Settings& settings);

/// Findings of `rio check` for recordings (Settings::data) and flights with a fault, and without.
Result checks(const Settings& settings);

/// One flight of Settings::hours: memory, errors, symmetry, norms and times, and whether runs and
/// orders of calls agree to the bit.
Result soak(const Settings& settings);

/// One experiment of the list.
struct Experiment {
  const char* name;
  const char* summary;
  Result (*run)(const Settings& settings);
};

/// All of them.
inline const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = {
      {"icra2023", "the tables of Michalczyk et al. 2023: accuracy, contributions, time",
       &icra2023},
      {"iros2024", "filter and sliding window: accuracy, wrong start, time, robust kernels",
       &iros2024},
      {"uncertainty", "Xu et al.: weights and matching by the noise of each point", &uncertainty},
      {"consistency", "NEES and NIS over matched runs, with their bounds", &consistency},
      {"ablation", "the default preset with one mechanism off at a time", &ablation},
      {"robustness", "every scenario with every preset", &robustness},
      {"faults", "every fault with both back-ends: survived, or reported", &fault_campaign},
      {"real", "every recording of the folder --data, also perturbed", &real},
      {"benchmark", "every recording below --data: ATE, RPE, NEES, time, verdict", &benchmark},
      {"control", "drives of --data with an ideal IMU, one cause of noise at a time", &control},
      {"checks", "what `rio check` says of faults in flights and in recordings of --data", &checks},
      {"soak", "a flight of --hours in one go: what grows, drifts or depends on the order", &soak},
  };
  return all;
}

/// The presets that experiments compare, the best first.
inline const std::vector<Variant>& presets_compared() {
  static const std::vector<Variant> presets = {{"default", "default"},
                                               {"published-ekf", "published-ekf"}};
  return presets;
}

}  // namespace rio::experiment

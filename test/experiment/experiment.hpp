// SPDX-License-Identifier: BSD-3-Clause
// The experiments: each answers one question with many simulated flights or
// recordings, as tables and charts.
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

struct Result {
  std::string markdown;  ///< tables with explanations
  std::vector<Attachment> attachments{};
};

// What each does is said by kExperiments and at the top of its file. Those of recordings
// throw std::runtime_error without Settings::data.
Result icra2023(const Settings& settings);
Result iros2024(const Settings& settings);
Result consistency(const Settings& settings);
Result ablation(const Settings& settings);
Result ablation_real(const Settings& settings);
Result robustness(const Settings& settings);
Result fault_campaign(const Settings& settings);
Result real(const Settings& settings);
Result control(const Settings& settings);
Result benchmark(const Settings& settings);  ///< bags of Settings::dataset, and folders
Result checks(const Settings& settings);     ///< Settings::data may be empty

struct Experiment {
  const char* name;
  const char* summary;
  Result (*run)(const Settings& settings);
};

inline constexpr Experiment kExperiments[] = {
    {"icra2023", "the tables of Michalczyk et al. 2023: accuracy, contributions, time", &icra2023},
    {"iros2024", "filter and sliding window: accuracy, wrong start, time", &iros2024},
    {"consistency", "NEES and NIS over matched runs, with their bounds", &consistency},
    {"ablation", "the default preset with one mechanism off at a time", &ablation},
    {"ablation-real", "the same on the recordings of --data", &ablation_real},
    {"robustness", "every scenario with every preset", &robustness},
    {"faults", "every fault with both back-ends: survived, or reported", &fault_campaign},
    {"real", "every recording of the folder --data, also perturbed", &real},
    {"control", "real drives with one cause of error at a time: whose error is it?", &control},
    {"benchmark", "every recording below --data: ATE, RPE, NEES, time, verdict", &benchmark},
    {"checks", "what `rio check` says of faults in flights and in recordings of --data", &checks},
};

}  // namespace rio::experiment

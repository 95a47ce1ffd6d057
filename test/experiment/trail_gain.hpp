// SPDX-License-Identifier: BSD-3-Clause
// With which radar do trails and landmarks help? The filter of 2023 with the Doppler alone, with
// one past scan like its predecessor, and with seven and ten.
#pragma once

#include <string>
#include <vector>

#include "experiment/campaign.hpp"

namespace rio::experiment {

/// The filter before that of 2023 (Michalczyk et al. 2022): trails of one past scan, no landmarks.
inline constexpr const char* kOnePastScan = "published-ekf: one past scan, Doppler, trails";

/// `published-ekf` with one past scan (trails, no landmarks) and with N = 7 and N = 10.
std::vector<Variant> clone_variants();

/// A row per radar, a column per variant, over the seven flights; the runs are added to `runs`.
std::string trail_gain_table(const Settings& settings, std::vector<Outcome>* runs);

}  // namespace rio::experiment

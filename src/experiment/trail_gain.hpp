// SPDX-License-Identifier: BSD-3-Clause
// With which radar do trails and landmarks pay? The filter of 2023 with the Doppler alone, with one
// past scan as its predecessor had, and with seven and ten.
#pragma once

#include <string>
#include <vector>

#include "experiment/campaign.hpp"

namespace rio::experiment {

/// `published-ekf` with one past scan (trails, no landmarks) and with N = 7 and N = 10.
std::vector<Variant> clone_variants();

/// A row a radar, a column a variant, over the seven flights; the runs are added to `runs`.
std::string trail_gain_table(const Settings& settings, std::vector<Outcome>* runs);

}  // namespace rio::experiment

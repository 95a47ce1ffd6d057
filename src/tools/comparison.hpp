// SPDX-License-Identifier: BSD-3-Clause
// Several estimates side by side.
#pragma once

#include <string>
#include <vector>

#include "rio/eval/evaluation.hpp"
#include "rio/eval/stamped_pose.hpp"

namespace rio::tools {

/// Rows of cells, the first is the head.
using TextTable = std::vector<std::vector<std::string>>;

/// The error figures, a row per estimate.
TextTable comparison_table(const std::vector<std::string>& names,
                           const std::vector<eval::Evaluation>& all);

/// In Markdown.
void print_table(const TextTable& rows);

/// Throws std::runtime_error with both spans if two trajectories have no time in common: they are
/// not of one recording, or not in one clock.
void expect_common_time(const std::vector<std::string>& names,
                        const std::vector<eval::Trajectory>& trajectories);

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// Evaluations of estimates, without output: for the program and for Python; and as tables.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "rio/eval/evaluation.hpp"

namespace rio::tools {

/// @param arguments with an alignment that there is
/// @param name of the estimate, for messages
/// @throws std::runtime_error if fewer than two poses can be paired
eval::Evaluation evaluate_poses(const EvaluateArguments& arguments, const eval::Trajectory& truth,
                                const eval::Trajectory& estimate, const std::string& name);

/// The JSON line of `rio evaluate --json`.
std::string evaluation_json(const EvaluateArguments& arguments, const std::string& estimate,
                            const eval::Evaluation& evaluation);

/// Rows of cells, the first is the head.
using TextTable = std::vector<std::vector<std::string>>;

/// The error figures, a row per estimate.
using NamedEvaluation = std::pair<std::string, eval::Evaluation>;
TextTable comparison_table(const std::vector<NamedEvaluation>& all);

/// In Markdown.
void print_table(const TextTable& rows);

/// Names of files in a picture: without folder and extension; with the folder if two would be
/// equal; as given if they still are.
std::vector<std::string> default_labels(const std::vector<std::string>& paths);

/// Lays the estimate over the truth in this way.
/// @return its pairs with the true poses
std::vector<eval::PosePair> lay_over(const eval::Trajectory& truth, const std::string& align,
                                     eval::Trajectory* estimate);

/// Throws std::runtime_error with both spans if two trajectories have no time in common: they are
/// not of one recording, or not in one clock.
using NamedPath = std::pair<std::string, eval::Trajectory>;
void expect_common_time(const std::vector<NamedPath>& paths);

}  // namespace rio::tools

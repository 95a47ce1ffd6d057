// SPDX-License-Identifier: BSD-3-Clause
// The evaluation of one estimate, without output: for the program and for Python.
#pragma once

#include <string>

#include "commands.hpp"
#include "rio/eval/evaluation.hpp"

namespace rio::tools {

/// @param name of the estimate, for messages
/// @throws std::runtime_error if there is no such alignment, or fewer than two poses can be paired
eval::Evaluation evaluate_poses(const EvaluateArguments& arguments, const eval::Trajectory& truth,
                                const eval::Trajectory& estimate, const std::string& name);

/// The JSON line of `rio evaluate --json`.
std::string evaluation_json(const EvaluateArguments& arguments, const std::string& estimate,
                            const eval::Evaluation& evaluation);

}  // namespace rio::tools

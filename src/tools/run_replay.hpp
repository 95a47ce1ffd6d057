// SPDX-License-Identifier: BSD-3-Clause
// The run of `rio replay`, for commands that print something else of it.
#pragma once

#include <string>

#include "commands.hpp"
#include "replay_summary.hpp"
#include "view_outputs.hpp"

namespace rio::tools {

/// Runs the recording and writes the trajectory files that the arguments name.
/// @param view begun and given every scan; the caller closes it
/// @param damage position of damage in the recording, else empty: the run ends there
/// @throws std::runtime_error if the estimator never started
ReplaySummary run_replay(const ReplayArguments& arguments, ViewOutputs* view, std::string* damage);

}  // namespace rio::tools

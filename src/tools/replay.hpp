// SPDX-License-Identifier: BSD-3-Clause
// The replay itself, for the program and for Python.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "replay_summary.hpp"
#include "rio/rio.hpp"
#include "view_outputs.hpp"

namespace rio::tools {

/// Called after each processed scan.
using OnScan = std::function<void(const Odometry&)>;

struct Replayed {
  ReplaySummary summary;
  std::vector<std::string> notes;  ///< of the recording and of the options
  std::string damage;              ///< empty, or where the recording is damaged: it ends there
};

/// Writes the trajectory files of the arguments; prints notes, lines and progress unless they are
/// silent.
/// @param view begun and given every scan; the caller closes it
/// @throws std::runtime_error if the estimator did not start; a lost estimate is in the summary
Replayed run_replay(const ReplayArguments& arguments, ViewOutputs* view,
                    const OnScan& on_scan = {});

}  // namespace rio::tools

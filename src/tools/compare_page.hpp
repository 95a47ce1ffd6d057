// SPDX-License-Identifier: BSD-3-Clause
// The page of `rio compare --report`.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "rio/eval/pairing.hpp"
#include "view/page.hpp"

namespace rio::tools {

/// One run: a recording with settings, or the file of another estimator.
struct Run {
  std::string name;
  eval::Trajectory poses;
  std::string verdict;  ///< of a replay
  std::string damage;   ///< of its recording
};

/// Within it a run is interpolated.
inline constexpr auto kGap = std::chrono::milliseconds(1500);

/// The runs as they are shown: paths, errors if there is a truth, and differences from the first.
view::Page page_of(const std::vector<Run>& runs, const eval::Trajectory& truth);

}  // namespace rio::tools

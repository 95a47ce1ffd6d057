// SPDX-License-Identifier: BSD-3-Clause
// Where a replay begins: at the ground truth, at a state from a file, or at rest.
#pragma once

#include <optional>
#include <string>

#include "commands.hpp"
#include "recording.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::tools {

/// First state and covariance, with their source.
struct Start {
  NavState state;
  BodyCovariance covariance;
  std::string source;
};

/// Empty for a static start.
std::optional<Start> make_start(const ReplayArguments& arguments, const OpenRecording& recording,
                                const Options& options);

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// The loop of `rio replay`: samples and scans of a recording, as a flight stack would feed them.
#pragma once

#include "check/clock_steps.hpp"
#include "recording.hpp"
#include "replay.hpp"

namespace rio::tools {

/// Feeds the recording to an estimator with these options.
/// @param steps of the clocks, to be taken out
/// @param on_scan called after every scan, unless empty
/// @throws std::runtime_error if the start is refused, or the estimate is not finite
ReplaySummary fly(const ReplayArguments& arguments, const OpenRecording& recording,
                  const Options& options, check::ClockSteps steps, ViewOutputs* view,
                  const OnScan& on_scan);

}  // namespace rio::tools

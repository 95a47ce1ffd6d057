// SPDX-License-Identifier: BSD-3-Clause
// What of a recording is checked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "check/check.hpp"
#include "replay_feed.hpp"
#include "rio/io/recording_stream.hpp"

namespace rio::tools {

/// The beginning of a recording, for `rio check`: all of one of ten minutes.
struct CheckedPart {
  check::CheckedData data;
  std::optional<double> seconds;  ///< its length; empty: it is all
};
/// @param sensors their properties
CheckedPart read_checked_part(io::RecordingStream* stream, const io::Dataset& sensors);

/// Of each sensor, as the checked part of the recording shows them. It is read only if some stamps
/// look like steps.
/// @param options with the sensor properties of the recording
/// @param notes one more for every step
check::ClockSteps find_clock_steps(io::RecordingStream* stream, const io::Dataset& sensors,
                                   const Options& options, std::vector<std::string>* notes);

/// Takes the steps of all clocks out of a recording, with a note for each.
/// @param options with the sensor properties of the recording
void take_out_clock_steps(const Options& options, io::Dataset* dataset);

}  // namespace rio::tools

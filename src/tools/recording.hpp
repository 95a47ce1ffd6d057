// SPDX-License-Identifier: BSD-3-Clause
// A recording in any supported format: ASL folder, ROS 1 bag, MCAP, sqlite3 of rosbag2.
#pragma once

#include <memory>
#include <string>

#include "commands.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/recording_stream.hpp"

namespace rio::tools {

/// Reads it; where its file is damaged the data set ends, and says so.
/// @param truth also reads the ground truth of a bag
io::Dataset read_any(const std::string& path, const RecordingArguments& arguments,
                     bool truth = false);

/// The same as a stream.
struct OpenRecording {
  std::unique_ptr<io::RecordingStream> samples;
  io::Dataset sensors;  ///< their properties, and the start of the ground truth; no samples
};
/// Checks all of it. Its notes are in `sensors`, damage is in the outline of the samples.
OpenRecording open_any(const std::string& path, const RecordingArguments& arguments,
                       bool truth = false);

/// "750 scans", of several radars "750 + 749 scans".
std::string scans_text(const io::Dataset& dataset);

/// What is added to stamps, as "-0.2 s"; 0 if nothing is said.
/// @param option for the error if that is no offset of stamps
/// @throws std::runtime_error
double stamp_offset(const std::string& said, const char* option);

/// Throws the damage of a recording, if any: the readable part has been used by then.
void throw_damage(const std::string& damage);

}  // namespace rio::tools

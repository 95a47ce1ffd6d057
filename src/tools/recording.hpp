// SPDX-License-Identifier: BSD-3-Clause
// A recording in any form the program knows: ASL folder, ROS 1 bag, MCAP, sqlite3 of rosbag2.
#pragma once

#include <filesystem>
#include <string>

#include "commands.hpp"
#include "rio/io/dataset.hpp"

namespace rio::tools {

/// Whether it is a recording in ASL layout.
bool is_asl_folder(const std::filesystem::path& path);

/// Reads it and prints its notes on stderr.
/// @param damage where the file is damaged, else empty; the data set is what stands before
io::Dataset read_any(const std::string& path, const RecordingArguments& arguments,
                     std::string* damage, io::Truth truth = io::Truth::kAll);

/// Throws what read_any() left in `damage`, if anything: what was readable has been used by then.
void throw_damage(const std::string& damage);

}  // namespace rio::tools

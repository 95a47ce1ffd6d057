// SPDX-License-Identifier: BSD-3-Clause
// Reads sensor.yaml of IMU and radars; private to io.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rio/io/dataset.hpp"

namespace rio::io {

/// A missing file is a note.
void read_imu_info(const std::filesystem::path& path, Dataset* dataset);
/// A missing file, and a file without T_BS, are notes.
void read_radar_info(const std::filesystem::path& path, RadarInfo* info,
                     std::vector<std::string>* notes);

}  // namespace rio::io

// SPDX-License-Identifier: BSD-3-Clause
// `rio check`: do the data of a recording agree with the assumptions of an estimator?
#pragma once

#include <filesystem>
#include <vector>

#include "check/finding.hpp"
#include "check/scans.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::check {

/// All findings in the order of the sensors: IMU, clocks, radar, motion, and the last three for
/// every further radar with "radar1: " before the subject. Later checks use the units found by
/// earlier ones.
/// @param options with the sensor properties of the recording
/// @param folder of the recording, to name lines of its files; may be empty
Findings check_recording(const io::Dataset& dataset, const Options& options, Source source,
                         const std::filesystem::path& folder = {});

/// The checked data of a recording that is not in a data set.
struct CheckedData {
  io::Dataset sensors;  ///< their properties
  std::vector<ImuSample> imu;
  std::vector<Scans> radars;  ///< radar0, radar1, ...; those of `sensors`
};
Findings check_recording(const CheckedData& data, const Options& options, Source source,
                         const std::filesystem::path& folder = {});

}  // namespace rio::check

// SPDX-License-Identifier: BSD-3-Clause
// `rio check`: is a recording what an estimator takes it to be?
#pragma once

#include <filesystem>
#include <vector>

#include "check/finding.hpp"
#include "check/scans.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::check {

/// All findings in the order of the sensors: IMU, clocks, radar, motion, and the last three of
/// every further radar with "radar1: " before the subject. What was found out about units is taken
/// into account in what follows.
/// @param options with what the recording says of its sensors
/// @param folder of the recording, to name lines of its files; may be empty
Findings check_recording(const io::Dataset& dataset, const Options& options, Source source,
                         const std::filesystem::path& folder = {});

/// What is checked of a recording, where that is not in a data set.
struct CheckedData {
  io::Dataset sensors;  ///< what is told of them
  std::vector<ImuSample> imu;
  std::vector<Scans> radars;  ///< radar0, radar1, ...; those of `sensors`
};
Findings check_recording(const CheckedData& data, const Options& options, Source source,
                         const std::filesystem::path& folder = {});

}  // namespace rio::check

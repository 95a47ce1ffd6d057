// SPDX-License-Identifier: BSD-3-Clause
// Checks of the radar without a model of the motion: clock, rate, points, distances, Doppler.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "check/advice.hpp"
#include "check/imu_check.hpp"
#include "check/motion.hpp"
#include "check/scans.hpp"
#include "rio/io/dataset.hpp"

namespace rio::check {

/// Whether the stamps of both sensors overlap.
Finding check_clocks(const std::vector<ImuSample>& imu, const Scans& scans, const Advice& advice);

/// Stamps of the radar in another unit than those of the IMU, subject "clocks"; empty if they are
/// in the same.
std::optional<Finding> check_stamp_unit(const std::vector<ImuSample>& imu, const Scans& scans);

/// @param speeds of radar_speeds()
/// @param csv the file of the scans, to name lines of it; may be empty
Findings check_radar(const Scans& scans, const io::RadarInfo& info,
                     const std::vector<RadarSpeed>& speeds, const CheckedImu& imu,
                     const Options& options, const Advice& advice,
                     const std::filesystem::path& csv);

}  // namespace rio::check

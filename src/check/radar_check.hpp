// SPDX-License-Identifier: BSD-3-Clause
// Checks of the radar alone: clock, rate, points, distances, Doppler.
#pragma once

#include <filesystem>
#include <vector>

#include "check/advice.hpp"
#include "check/motion.hpp"
#include "check/scans.hpp"
#include "rio/io/dataset.hpp"

namespace rio::check {

/// Whether the stamps of both sensors overlap.
Finding check_clocks(const std::vector<ImuSample>& imu, const Scans& scans, const Advice& advice);

/// @param speeds of radar_speeds()
/// @param csv the file of the scans, to name lines of it; may be empty
Findings check_radar(const Scans& scans, const io::RadarInfo& info,
                     const std::vector<RadarSpeed>& speeds, const Options& options,
                     const Advice& advice, const std::filesystem::path& csv);

/// The largest Doppler except for one of a thousand [m/s]: where a radar folds whose limit is
/// configured in another unit.
double fastest(const Scans& scans);

}  // namespace rio::check

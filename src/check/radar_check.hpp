// SPDX-License-Identifier: BSD-3-Clause
// Checks of the radar without a model of the motion: clock, rate, points, distances, Doppler.
#pragma once

#include <filesystem>
#include <vector>

#include "check/advice.hpp"
#include "check/imu_check.hpp"
#include "check/motion.hpp"
#include "check/scans.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::check {

/// Of the stamps [ns]: 1, or that in which whole scans would come faster than any radar measures.
double stamp_unit(const Scans& scans);

/// Whether the stamps of both sensors are in ns and overlap.
Finding check_clocks(const std::vector<ImuSample>& imu, const Scans& scans, const Advice& advice);

/// @param speeds of radar_speeds()
/// @param csv the file of the scans, to name lines of it; may be empty
Findings check_radar(const Scans& scans, const io::RadarInfo& info,
                     const std::vector<RadarSpeed>& speeds, const CheckedImu& imu,
                     const Options& options, const Advice& advice,
                     const std::filesystem::path& csv);

/// The Doppler of a radar: its columns, its limit, and whether it is zero at rest.
Finding check_doppler(const Scans& scans, const CheckedImu& imu, const Options& options,
                      const Advice& advice);

/// The largest Doppler except for one of a thousand [m/s]: where a radar folds whose limit is
/// configured in another unit.
double fastest(const Scans& scans);

}  // namespace rio::check

// SPDX-License-Identifier: BSD-3-Clause
// What the scans say of themselves: clock, rate, points, Doppler.
#pragma once

#include <vector>

#include "check/finding.hpp"
#include "check/motion.hpp"
#include "rio/io/dataset.hpp"

namespace rio::check {

/// Whether both sensors were there at the same time, by their stamps.
Finding check_clocks(const io::Dataset& dataset, Source source);

/// @param speeds of radar_speeds()
Findings check_radar(const io::Dataset& dataset, const std::vector<RadarSpeed>& speeds,
                     const Options& options, Source source);

/// The largest Doppler but for one of a thousand [m/s]; where a radar folds that is told a limit in
/// another unit.
double fastest(const std::vector<RadarScan>& scans);

}  // namespace rio::check

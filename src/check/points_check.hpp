// SPDX-License-Identifier: BSD-3-Clause
// From the points of scans that follow each other: the sign and the unit of the Doppler and the
// unit of the gyro, with a handful of noisy points a scan, too. Neither velocity nor mounting is
// needed.
//
// Points i of one scan and j of a scan dt later that look alike are the same reflector more often
// than chance has it; those that are not fit no hypothesis better than another. Each hypothesis k
// supports some of the pairs:
// (E1) |r_j - r_i - k d dt| < 3 sigma_r: k d is the range rate, d the mean of both Dopplers
// (E2) |Exp(-k w dt) u_i - u_j| < 3 sigma_u: k w is the rate, in the axes of the radar
// (E3) two hypotheses are compared by the pairs of which both cannot be right: in each block of two
//      seconds by the difference of their counts, over all blocks by Student's t of these, whatever
//      ties pairs of the same points together
#pragma once

#include <optional>
#include <vector>

#include "check/finding.hpp"
#include "check/scans.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// Sign and unit of the Doppler by (E1), subject "Doppler by the ranges".
Finding check_ranges(const Scans& scans, const Options& options, Source source);

/// Whether the gyro is in deg/s by (E2), subject "gyro unit by the points"; nothing if it is not.
/// The rates as told may be right with any mounting and handedness by right angles.
/// @param samples usable()
std::optional<Finding> check_rates(const std::vector<ImuSample>& samples, const Scans& scans,
                                   const Options& options, Source source);

}  // namespace rio::check

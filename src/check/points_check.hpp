// SPDX-License-Identifier: BSD-3-Clause
// Checks from the points of consecutive scans: the sign and the unit of the Doppler and the unit of
// the gyro, also with a handful of noisy points a scan. Neither velocity nor mounting is needed.
//
// Similar points i of one scan and j of a scan dt later are the same reflector more often than by
// chance; other pairs support no hypothesis more than another. Each hypothesis k supports some of
// the pairs:
// (E1) |r_j - r_i - k d dt| < 3 sigma_r: k d is the range rate, d the mean of both Dopplers
// (E2) |Exp(-k w dt) u_i - u_j| < 3 sigma_u: k w is the rate, in the axes of the radar
// (E3) two hypotheses are compared by the pairs that fit only one of them: in each block of two
//      seconds by the difference of their counts, over all blocks by Student's t of these, whatever
//      the dependence of pairs of the same points
//
// Directions must be those from the radar. With points moved by o the Doppler of a static one is
// (E4) d = -v^T (p - o) / |p - o|, v of each scan and o of all by least squares: o is far from zero
//      if the driver gives the points in the frame of the vehicle.
#pragma once

#include <optional>
#include <vector>

#include "check/advice.hpp"
#include "check/axes.hpp"
#include "check/scans.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// Whether many points are sent again with later scans, subject "repeated points"; empty if not.
std::optional<Finding> check_repeated(const Scans& scans);

struct RangeCheck {
  Finding finding;  ///< subject "Doppler by the ranges"
  DopplerSign sign = DopplerSign::kUnknown;
};

/// Sign and unit of the Doppler by (E1).
RangeCheck check_ranges(const Scans& scans, const Options& options, const Advice& advice);

/// Whether the points are counted from another place than the radar, by (E4), subject "origin of
/// the points"; empty if not. Less than some decimetres do not show, and nothing at rest.
std::optional<Finding> check_origin(const Scans& scans, const Advice& advice);

/// Whether elevations are counted from the zenith, subject "elevation"; empty if not. The residuals
/// of (E4) with o = 0 tell, those of points that move count little.
std::optional<Finding> check_elevations(const Scans& scans, const Advice& advice);

/// Whether the gyro is in deg/s by (E2), subject "gyro unit by the points"; empty if it is not.
/// The rates as configured may fit with any mounting and handedness by right angles.
/// @param samples CheckedImu::good
std::optional<Finding> check_rates(const std::vector<ImuSample>& samples, const Scans& scans,
                                   const Options& options, const Advice& advice);

}  // namespace rio::check

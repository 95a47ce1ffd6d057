// SPDX-License-Identifier: BSD-3-Clause
// The delay of the stamps of the radar, by the shift with which the motion of radar and IMU agrees
// best: every 20 ms up to 0.28 s to both sides of the configured delay, and up to four seconds
// where these are not enough.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "check/advice.hpp"
#include "check/motion.hpp"
#include "check/motion_data.hpp"
#include "rio/options.hpp"

namespace rio::check {

/// The largest share (E4) of motion.hpp with the axes of any of the candidates() that the sign of
/// the Doppler allows.
double most_explained(const Agreement& windows, const Options& options, DopplerSign sign);

/// The windows for every shift, from the most negative on.
/// @param length of a window [s]
std::vector<Agreement> all_shifts(const MotionData& data, double length, const RadarOptions& radar);

/// The windows in which the axes are judged: at the configured delay, unless another shift is
/// significantly better with some axes.
/// @param shifts of all_shifts(), like those below
const Agreement& windows_to_judge(const std::vector<Agreement>& shifts, const Options& options,
                                  DopplerSign sign);

/// Whether the first or the last shift explains the motion best.
bool ends_at_the_best(const std::vector<Agreement>& shifts, const Options& options,
                      DopplerSign sign);

/// @param R axes of the radar as found
Finding check_delay(const std::vector<Agreement>& shifts, const Matrix3d& R, const Options& options,
                    const Advice& advice);

/// A delay beyond those of check_delay(), with which radar and IMU agree at last; empty if there is
/// none.
/// @param near explained at most with those of check_delay()
std::optional<Finding> check_far_delay(const MotionData& data, double length, double near,
                                       const Options& options, const Advice& advice);

}  // namespace rio::check

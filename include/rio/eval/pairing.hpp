// SPDX-License-Identifier: BSD-3-Clause
// Pairs the poses of an estimate with the true poses at the same times.
//
// Both functions accept unsorted input; of poses with equal stamps the first is used. There is no
// extrapolation: an estimate outside the truth, or inside one of its gaps, is not paired.
#pragma once

#include <cstddef>
#include <vector>

#include "rio/eval/stamped_pose.hpp"

namespace rio::eval {

/// A true pose and the estimate of it.
struct PosePair {
  StampedPose truth;
  StampedPose estimate;
};

/// The pairs by increasing time of the estimate, and the number of estimates.
struct Association {
  std::vector<PosePair> pairs;
  std::size_t estimates = 0;  ///< distinct stamps of the estimate
};

/// By increasing time; of poses with equal stamps the first is kept.
Trajectory sorted_without_duplicates(Trajectory poses);

/// The pose between a and b at `time`: position linear, attitude by slerp.
StampedPose interpolate(const StampedPose& a, const StampedPose& b, Time time);

/// Half of all intervals between stamps are at most this long; 0 with fewer than two poses.
Time median_interval(const Trajectory& trajectory);

/// Pairs each estimate with the nearest true pose at most `max_difference` away. A true pose is
/// used once: by the closest of several estimates, or the earlier of equally close ones.
Association associate_nearest(const Trajectory& truth, const Trajectory& estimate,
                              Time max_difference = std::chrono::milliseconds(10));

/// Pairs each estimate with the truth interpolated at its stamp, unless the two true poses around
/// it are more than `max_gap` apart.
Association associate_interpolated(const Trajectory& truth, const Trajectory& estimate,
                                   Time max_gap = std::chrono::milliseconds(100));

/// Interpolated, few poses fall into gaps: the median interval is at most 70 % of `max_gap`.
bool is_dense(const Trajectory& poses, Time max_gap = std::chrono::milliseconds(100));

/// Interpolates the truth at the stamps of the estimate if it is_dense(), else the estimate at
/// those of the truth if that is dense, as of a total station at 5 Hz; else takes the nearest.
Association associate(const Trajectory& truth, const Trajectory& estimate,
                      Time max_difference = std::chrono::milliseconds(10),
                      Time max_gap = std::chrono::milliseconds(100));

}  // namespace rio::eval

// SPDX-License-Identifier: BSD-3-Clause
// Pairs the poses of an estimate with the true poses at the same instants.
//
// Both functions accept unsorted input; of poses with equal stamps the first counts. Neither
// extrapolates: an estimate outside the truth, or inside one of its gaps, stays without a partner.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

#include "rio/eval/stamped_pose.hpp"

namespace rio::eval {

/// A true pose and the estimate of it.
struct PosePair {
  StampedPose truth;
  StampedPose estimate;
};

/// The pairs, by increasing time of the estimate, and what was left over.
struct Association {
  std::vector<PosePair> pairs;
  std::size_t estimates = 0;  ///< distinct stamps of the estimate

  std::size_t unmatched() const { return estimates - pairs.size(); }
  /// Share of the estimates that have a true pose; 0 without estimates.
  double completeness() const {
    return estimates == 0 ? 0.0
                          : static_cast<double>(pairs.size()) / static_cast<double>(estimates);
  }
};

namespace association_detail {

inline bool earlier(const StampedPose& a, const StampedPose& b) {
  return a.time < b.time;
}

inline Trajectory sorted_without_duplicates(Trajectory poses) {
  std::stable_sort(poses.begin(), poses.end(), earlier);
  const auto same_time = [](const StampedPose& a, const StampedPose& b) {
    return a.time == b.time;
  };
  poses.erase(std::unique(poses.begin(), poses.end(), same_time), poses.end());
  return poses;
}

}  // namespace association_detail

/// The pose between a and b at `time`: position linear, attitude by slerp.
inline StampedPose interpolate(const StampedPose& a, const StampedPose& b, Time time) {
  const double s = to_seconds(time - a.time) / to_seconds(b.time - a.time);
  return {time, a.p + s * (b.p - a.p), a.q.slerp(s, b.q)};
}

/// Half of all intervals between stamps are at most this long; 0 with fewer than two poses.
inline Time median_interval(const Trajectory& trajectory) {
  const Trajectory poses = association_detail::sorted_without_duplicates(trajectory);
  if (poses.size() < 2) return Time(0);
  std::vector<Time> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i)
    intervals.push_back(poses[i].time - poses[i - 1].time);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>((intervals.size() - 1) / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// Pairs each estimate with the nearest true pose at most `max_difference` away. A true pose is
/// used once: of several estimates nearest to it the closest has it, of equally close ones the
/// earlier.
inline Association associate_nearest(const Trajectory& truth, const Trajectory& estimate,
                                     Time max_difference = std::chrono::milliseconds(10)) {
  const Trajectory truths = association_detail::sorted_without_duplicates(truth);
  const Trajectory estimates = association_detail::sorted_without_duplicates(estimate);
  Association result;
  result.estimates = estimates.size();
  for (const StampedPose& pose : estimates) {
    auto nearest =
        std::lower_bound(truths.begin(), truths.end(), pose, association_detail::earlier);
    if (nearest == truths.end() ||
        (nearest != truths.begin() &&
         pose.time - std::prev(nearest)->time <= nearest->time - pose.time)) {
      if (nearest == truths.begin()) continue;  // there is no truth
      --nearest;
    }
    const auto distance = [](Time a, Time b) { return a < b ? b - a : a - b; };
    const Time difference = distance(nearest->time, pose.time);
    if (difference > max_difference) continue;
    // claims of one true pose follow each other, for both sequences increase
    if (!result.pairs.empty() && result.pairs.back().truth.time == nearest->time) {
      if (difference < distance(nearest->time, result.pairs.back().estimate.time)) {
        result.pairs.back().estimate = pose;
      }
      continue;
    }
    result.pairs.push_back({*nearest, pose});
  }
  return result;
}

/// Pairs each estimate with the truth interpolated at its stamp, unless the two true poses around
/// it are more than `max_gap` apart.
inline Association associate_interpolated(const Trajectory& truth, const Trajectory& estimate,
                                          Time max_gap = std::chrono::milliseconds(100)) {
  const Trajectory truths = association_detail::sorted_without_duplicates(truth);
  const Trajectory estimates = association_detail::sorted_without_duplicates(estimate);
  Association result;
  result.estimates = estimates.size();
  for (const StampedPose& pose : estimates) {
    const auto next =
        std::lower_bound(truths.begin(), truths.end(), pose, association_detail::earlier);
    if (next == truths.end()) break;
    if (next->time == pose.time) {
      result.pairs.push_back({*next, pose});
    } else if (next != truths.begin() && next->time - std::prev(next)->time <= max_gap) {
      result.pairs.push_back({interpolate(*std::prev(next), *next, pose.time), pose});
    }
  }
  return result;
}

/// Interpolates when the truth is dense (median interval below `max_gap`), else takes the nearest.
inline Association associate(const Trajectory& truth, const Trajectory& estimate,
                             Time max_difference = std::chrono::milliseconds(10),
                             Time max_gap = std::chrono::milliseconds(100)) {
  const Time interval = median_interval(truth);
  if (interval > Time(0) && interval < max_gap) {
    return associate_interpolated(truth, estimate, max_gap);
  }
  return associate_nearest(truth, estimate, max_difference);
}

}  // namespace rio::eval

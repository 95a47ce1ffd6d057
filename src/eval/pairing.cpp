// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/pairing.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace rio::eval {

namespace {

bool earlier(const StampedPose& a, const StampedPose& b) {
  return a.time < b.time;
}

}  // namespace

Trajectory sorted_without_duplicates(Trajectory poses) {
  std::stable_sort(poses.begin(), poses.end(), earlier);
  const auto same_time = [](const StampedPose& a, const StampedPose& b) {
    return a.time == b.time;
  };
  poses.erase(std::unique(poses.begin(), poses.end(), same_time), poses.end());
  return poses;
}

StampedPose interpolate(const StampedPose& a, const StampedPose& b, Time time) {
  const double s = to_seconds(time - a.time) / to_seconds(b.time - a.time);
  return {time, a.p + s * (b.p - a.p), a.q.slerp(s, b.q)};
}

Time median_interval(const Trajectory& trajectory) {
  const Trajectory poses = sorted_without_duplicates(trajectory);
  if (poses.size() < 2) return Time(0);
  std::vector<Time> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i)
    intervals.push_back(poses[i].time - poses[i - 1].time);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>((intervals.size() - 1) / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

Association associate_nearest(const Trajectory& truth, const Trajectory& estimate,
                              Time max_difference) {
  const Trajectory truths = sorted_without_duplicates(truth);
  const Trajectory estimates = sorted_without_duplicates(estimate);
  Association result;
  result.estimates = estimates.size();
  for (const StampedPose& pose : estimates) {
    auto nearest = std::lower_bound(truths.begin(), truths.end(), pose, earlier);
    if (nearest == truths.end() ||
        (nearest != truths.begin() &&
         pose.time - std::prev(nearest)->time <= nearest->time - pose.time)) {
      if (nearest == truths.begin()) continue;  // there is no truth
      --nearest;
    }
    const auto distance = [](Time a, Time b) { return a < b ? b - a : a - b; };
    const Time difference = distance(nearest->time, pose.time);
    if (difference > max_difference) continue;
    // claims of one true pose are consecutive, since both sequences increase
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

Association associate_interpolated(const Trajectory& truth, const Trajectory& estimate,
                                   Time max_gap) {
  const Trajectory truths = sorted_without_duplicates(truth);
  const Trajectory estimates = sorted_without_duplicates(estimate);
  Association result;
  result.estimates = estimates.size();
  for (const StampedPose& pose : estimates) {
    const auto next = std::lower_bound(truths.begin(), truths.end(), pose, earlier);
    if (next == truths.end()) break;
    if (next->time == pose.time) {
      result.pairs.push_back({*next, pose});
    } else if (next != truths.begin() && next->time - std::prev(next)->time <= max_gap) {
      result.pairs.push_back({interpolate(*std::prev(next), *next, pose.time), pose});
    }
  }
  return result;
}

bool is_dense(const Trajectory& poses, Time max_gap) {
  const Time interval = median_interval(poses);
  return interval > Time(0) && 10 * interval <= 7 * max_gap;  // jitter is no gap
}

Association associate(const Trajectory& truth, const Trajectory& estimate, Time max_difference,
                      Time max_gap) {
  if (is_dense(truth, max_gap)) return associate_interpolated(truth, estimate, max_gap);
  if (!is_dense(estimate, max_gap)) return associate_nearest(truth, estimate, max_difference);
  Association at_truth = associate_interpolated(estimate, truth, max_gap);
  for (PosePair& pair : at_truth.pairs) std::swap(pair.truth, pair.estimate);
  at_truth.estimates = sorted_without_duplicates(estimate).size();
  return at_truth;
}

}  // namespace rio::eval

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/evaluation.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace rio::eval {

using std::chrono::milliseconds;

namespace {

/// Poses that are no nearer in time.
Trajectory thinned(const Trajectory& all, Time interval) {
  Trajectory some;
  for (const StampedPose& pose : all) {
    if (some.empty() || pose.time - some.back().time >= interval) some.push_back(pose);
  }
  return some;
}

/// Of the positions about their mean, RMS [m].
double spread(const std::vector<PosePair>& pairs, StampedPose PosePair::*pose) {
  Vector3d mean = Vector3d::Zero();
  for (const PosePair& pair : pairs) mean += (pair.*pose).p / static_cast<double>(pairs.size());
  double squares = 0.0;
  for (const PosePair& pair : pairs) squares += ((pair.*pose).p - mean).squaredNorm();
  return std::sqrt(squares / static_cast<double>(pairs.size()));
}

}  // namespace

Evaluation evaluate(const Trajectory& truth, const Trajectory& estimate,
                    const EvaluationOptions& options) {
  if (truth.size() < 2) throw std::runtime_error("the truth has fewer than 2 poses");
  if (estimate.size() < 2) throw std::runtime_error("the estimate has fewer than 2 poses");
  const Association association =
      associate(truth, estimate, options.max_difference, options.max_gap);
  const std::vector<PosePair>& pairs = association.pairs;
  if (pairs.empty()) {
    const bool overlap =
        truth.front().time <= estimate.back().time && estimate.front().time <= truth.back().time;
    throw std::runtime_error(std::string("truth and estimate ") +
                             (overlap ? "are too sparse" : "do not overlap in time") +
                             ": no pose of the estimate has a true pose at its stamp" +
                             (overlap ? "; --max-diff allows more difference" : ""));
  }
  if (pairs.size() < 2) throw std::runtime_error("only 1 pose of the estimate has a true pose");

  Evaluation result;
  result.estimates = association.estimates;
  result.associated = pairs.size();
  result.duration = to_seconds(pairs.back().estimate.time - pairs.front().estimate.time);
  result.path_length = path_length(pairs);
  result.size_ratio = spread(pairs, &PosePair::truth) / spread(pairs, &PosePair::estimate);

  const Alignment yaw = align_yaw(pairs);
  const Alignment se3 = align_se3(pairs);
  result.ape_none = absolute_error(pairs);
  result.ape_yaw = absolute_error(transformed(yaw.transform, pairs));
  result.ape_se3 = absolute_error(transformed(se3.transform, pairs));
  result.yaw_unique = yaw.unique;
  result.se3_unique = se3.unique;

  const std::vector<PosePair> aligned =
      transformed(find_alignment(pairs, options.alignment).transform, pairs);
  result.rpe = {relative_error(aligned, 1.0), relative_error(aligned, 10.0),
                relative_error(aligned, 50.0)};
  result.norm_of_mae = norm_of_mae(aligned);
  if (!std::isnan(options.mae_distance)) {
    result.norm_of_mae_at = norm_of_mae(aligned, options.mae_distance);
  }
  result.norm_of_rmse = norm_of_rmse(aligned);
  result.final_drift = final_drift(aligned);
  result.yaw = yaw_errors(aligned);
  result.tilt = tilt_errors(aligned);
  return result;
}

StampOffset best_stamp_offset(const Trajectory& all_true, const Trajectory& all_estimates,
                              const EvaluationOptions& options) {
  if (all_true.empty() || all_estimates.empty()) return {};
  const Time duration = all_estimates.back().time - all_estimates.front().time;
  const Trajectory truth = thinned(all_true, milliseconds(40));  // as good to interpolate
  const bool at_estimates = is_dense(all_true, options.max_gap);
  const Trajectory estimate =
      thinned(all_estimates, at_estimates ? duration / 1000 : Time(milliseconds(40)));
  std::size_t paired = 0;  // without an offset
  const auto rmse = [&](Time offset) {
    Trajectory moved = estimate;
    for (StampedPose& pose : moved) pose.time -= offset;
    const std::vector<PosePair> pairs =
        associate(truth, moved, options.max_difference, options.max_gap).pairs;
    if (offset == Time(0)) paired = pairs.size();
    // over a short part of the way any error is small
    if (pairs.size() < 2 || 4 * pairs.size() < 3 * paired)
      return std::numeric_limits<double>::infinity();
    return absolute_error(transformed(align_yaw(pairs).transform, pairs)).translation.rmse;
  };
  StampOffset best;
  best.rmse = best.rmse_without = rmse(Time(0));
  Time middle{0};
  for (const Time step : {milliseconds(50), milliseconds(5), milliseconds(1)}) {
    const int most = step == milliseconds(50) ? 40 : 10;
    for (int i = -most; i <= most; ++i) {
      const Time offset = middle + i * step;
      const double error = rmse(offset);
      if (!(error < best.rmse)) continue;
      best.rmse = error;
      best.offset = offset;
    }
    middle = best.offset;
  }
  return best;
}

}  // namespace rio::eval

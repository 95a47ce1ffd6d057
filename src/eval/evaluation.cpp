// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/evaluation.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

namespace rio::eval {

Evaluation evaluate(const Trajectory& truth, const Trajectory& estimate,
                    const EvaluationOptions& options) {
  if (truth.size() < 2) throw std::runtime_error("the truth has fewer than 2 poses");
  if (estimate.size() < 2) throw std::runtime_error("the estimate has fewer than 2 poses");
  const Association association =
      associate(truth, estimate, options.max_difference, options.max_gap);
  const std::vector<PosePair>& pairs = association.pairs;
  if (pairs.empty()) {
    throw std::runtime_error(
        "truth and estimate do not overlap in time: no pose of the estimate has"
        " a true pose at its stamp");
  }
  if (pairs.size() < 2) throw std::runtime_error("only 1 pose of the estimate has a true pose");

  Evaluation result;
  result.estimates = association.estimates;
  result.associated = pairs.size();
  result.duration = to_seconds(pairs.back().estimate.time - pairs.front().estimate.time);
  result.path_length = path_length(pairs);

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

}  // namespace rio::eval

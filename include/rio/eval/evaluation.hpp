// SPDX-License-Identifier: BSD-3-Clause
// One call from two trajectories to all their error figures. Metres, seconds, degrees.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "rio/eval/alignment.hpp"
#include "rio/eval/association.hpp"
#include "rio/eval/metrics.hpp"

namespace rio::eval {

struct EvaluationOptions {
  AlignmentKind alignment = AlignmentKind::kNone;       ///< for all figures but the three `ape_`
  Time max_difference = std::chrono::milliseconds(10);  ///< of stamps, if the truth is sparse
  Time max_gap = std::chrono::milliseconds(100);        ///< longest that is interpolated
  double mae_distance = kNan;  ///< also give the norm of MAE up to this true path length [m]
};

/// All error figures of one estimate.
struct Evaluation {
  std::size_t estimates = 0;   ///< poses of the estimate
  std::size_t associated = 0;  ///< of these, poses with a true pose
  double duration = 0.0;       ///< from the first to the last associated pose [s]
  double path_length = 0.0;    ///< of the truth over that time [m]

  AbsoluteError ape_none;  ///< as is
  AbsoluteError ape_yaw;   ///< after yaw and position alignment
  AbsoluteError ape_se3;   ///< after SE(3) alignment
  bool yaw_unique = true;  ///< see Alignment::unique
  bool se3_unique = true;

  std::array<RelativeError, 3> rpe;  ///< over 1, 10 and 50 m
  double norm_of_mae = kNan;         ///< [m]
  double norm_of_mae_at = kNan;      ///< up to EvaluationOptions::mae_distance [m]
  double norm_of_rmse = kNan;        ///< [m]
  double final_drift = kNan;         ///< [%]
  AngleError yaw;                    ///< [deg]
  AngleError tilt;                   ///< [deg]
};

/// Compares `estimate` with `truth`.
/// @throws std::runtime_error if either has fewer than two poses or fewer than two share an instant
inline Evaluation evaluate(const Trajectory& truth, const Trajectory& estimate,
                           const EvaluationOptions& options = {}) {
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

// SPDX-License-Identifier: BSD-3-Clause
// One call from two trajectories to all their error figures. Metres, seconds, degrees.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "rio/eval/alignment.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/eval/pairing.hpp"

namespace rio::eval {

struct EvaluationOptions {
  AlignmentKind alignment = AlignmentKind::kNone;       ///< for all figures except the three `ape_`
  Time max_difference = std::chrono::milliseconds(10);  ///< of stamps, for a sparse truth
  Time max_gap = std::chrono::milliseconds(100);        ///< longest gap that is interpolated
  double mae_distance = kNan;  ///< also compute the norm of MAE up to this true path length [m]
};

/// All error figures of one estimate.
struct Evaluation {
  std::size_t estimates = 0;   ///< poses of the estimate
  std::size_t associated = 0;  ///< of these, poses with a true pose
  double duration = 0.0;       ///< from the first to the last associated pose [s]
  double path_length = 0.0;    ///< of the truth over that time [m]
  double size_ratio = kNan;  ///< spread of the true positions over the estimated; NaN: none has any

  AbsoluteError ape_none;  ///< without alignment
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
/// @throws std::runtime_error if either has fewer than two poses or fewer than two can be paired
Evaluation evaluate(const Trajectory& truth, const Trajectory& estimate,
                    const EvaluationOptions& options = {});

/// Added to the stamps of a truth on another clock.
struct StampOffset {
  Time offset{0};
  double rmse = kNan;          ///< of the position with it, after yaw and position alignment [m]
  double rmse_without = kNan;  ///< [m]

  /// Beyond what drift and noise make of stamps that are right.
  bool is_needed() const { return std::isfinite(rmse_without) && rmse < 0.5 * rmse_without; }
};

/// The offset within two seconds with the least error, from sorted poses; zero if fewer than two
/// can be paired.
StampOffset best_stamp_offset(const Trajectory& truth, const Trajectory& estimate,
                              const EvaluationOptions& options = {});

}  // namespace rio::eval

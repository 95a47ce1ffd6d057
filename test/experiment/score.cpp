// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/score.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rio/eval/metrics.hpp"

namespace rio::experiment {

namespace {

constexpr double kLostShare = 0.05;    // of the path
constexpr double kLostDistance = 2.0;  // [m]

constexpr double kMaeDistance = 127.0;  // of Table I of Michalczyk et al. 2023 [m]

double mean_nis(const Trial& trial, Model model) {
  const ModelReport& sum = trial.models[static_cast<std::size_t>(model)];
  return sum.rows_used == 0 ? eval::kNan : sum.nis / sum.rows_used;
}

}  // namespace

Score score(const Trial& trial) {
  Score s;
  s.complete = trial.complete;
  s.lost = true;
  if (trial.steps.empty()) {
    for (const Figure& figure : kFigures) s.*figure.value = eval::kNan;
    return s;
  }
  const std::vector<eval::PosePair> pairs = pose_pairs(trial);
  const double n = static_cast<double>(trial.steps.size());
  double squares = 0.0;
  for (const Step& step : trial.steps) {
    const BlockNees nees = block_nees(step);
    s.nees_position += nees.position / n;
    s.nees_attitude += nees.attitude / n;
    s.nees_heading += nees.heading / n;
    s.nees_velocity += nees.velocity / n;
    squares += (step.estimate.v_WB - step.truth.v_WB).squaredNorm() / n;
  }
  s.path_length = eval::path_length(pairs);
  s.final_error = (pairs.back().estimate.p - pairs.back().truth.p).norm();
  s.drift = eval::final_drift(pairs);
  s.mae = eval::norm_of_mae(pairs);
  s.mae_at_127 = eval::norm_of_mae(pairs, kMaeDistance);
  s.ape = eval::absolute_error(pairs).translation.rmse;
  s.heading = eval::yaw_errors(pairs).rmse;
  s.velocity = std::sqrt(squares);
  s.nis_doppler = mean_nis(trial, Model::kDoppler);
  s.nis_trails = mean_nis(trial, Model::kTrailDistance);
  s.nis_landmarks = mean_nis(trial, Model::kLandmarkDistance);
  s.nis_points = mean_nis(trial, Model::kLandmarkPoint);
  s.nis_positions = mean_nis(trial, Model::kLandmarkPosition);
  // not <=, so that a NaN counts as lost
  s.lost = !(s.complete && s.final_error <= std::max(kLostDistance, kLostShare * s.path_length));
  return s;
}

}  // namespace rio::experiment

// SPDX-License-Identifier: BSD-3-Clause
// A replay of a recording against its references.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "experiment/recording.hpp"
#include "rio/core/so3.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/eval/pairing.hpp"
#include "rio/io/barometer.hpp"

namespace rio::experiment {

namespace {

double heading(const Quaternion& q) {
  const Matrix3d R = q.toRotationMatrix();
  return std::atan2(R(1, 0), R(0, 0));
}

/// Each the mean of a second.
std::vector<io::BarometricHeights::Sample> barometer_heights(const io::Dataset& data) {
  const auto raw = io::barometric_heights(data.baro).samples;
  auto heights = raw;
  std::size_t first = 0;
  std::size_t end = 0;
  double sum = 0.0;
  for (auto& [time, height] : heights) {
    for (; end < raw.size() && to_seconds(raw[end].time - time) < 0.5; ++end) {
      sum += raw[end].height;
    }
    for (; to_seconds(time - raw[first].time) > 0.5; ++first) sum -= raw[first].height;
    height = sum / static_cast<double>(end - first);
  }
  return heights;
}

/// Sampled every half second, so that the jitter of the estimate does not count.
double length_of(const eval::Trajectory& poses) {
  double distance = 0.0;
  std::size_t last = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (to_seconds(poses[i].time - poses[last].time) < 0.5) continue;
    distance += (poses[i].p - poses[last].p).norm();
    last = i;
  }
  return distance;
}

void judge_against_reference(const eval::Trajectory& reference, const eval::Trajectory& poses,
                             RealScore* score) {
  const std::vector<eval::PosePair> pairs = eval::associate(reference, poses).pairs;
  if (pairs.empty()) return;
  const eval::PosePair& first = pairs.front();
  const double turn = heading(first.truth.q) - heading(first.estimate.q);
  const Quaternion R = quaternion_exp(Vector3d(0.0, 0.0, turn));
  const auto laid_over = [&](const Vector3d& p) -> Vector3d {
    return R * (p - first.estimate.p) + first.truth.p;
  };
  std::vector<double> errors;
  for (const eval::PosePair& pair : pairs) {
    errors.push_back((laid_over(pair.estimate.p) - pair.truth.p).head<2>().norm());
  }
  score->horizontal = eval::statistics(errors).rmse;
}

void judge_height(const Recording& recording, const Replay& replay, RealScore* score) {
  const bool flat = recording.flat();
  const auto heights = barometer_heights(recording.data);
  if (!flat && heights.empty()) return;
  std::vector<double> errors;
  std::vector<double> sigmas;
  double honest = 0.0;
  std::optional<double> zero;
  auto next = heights.begin();
  for (const RecordedStep& step : replay.steps) {
    double error = step.state.p_WB.z();
    if (!flat) {
      while (next != heights.end() && next->time < step.state.time) ++next;
      if (next == heights.end()) break;
      error -= next->height;
    }
    if (!zero) zero = error;
    error -= *zero;
    errors.push_back(error);
    honest += std::abs(error) < 3.0 * step.sigma_height() ? 1.0 : 0.0;
    if (2 * errors.size() > replay.steps.size()) {
      sigmas.push_back(std::abs(error) / step.sigma_height());
    }
  }
  score->height = eval::statistics(errors).rmse;
  if (!flat) return;  // a barometer with centimetres of noise validates no sigma
  score->honest = honest / static_cast<double>(errors.size());
  std::sort(sigmas.begin(), sigmas.end());
  score->sigmas_median = sigmas[sigmas.size() / 2];
  score->sigmas_worst = sigmas.back();
}

void judge_rest(const Recording& recording, const Replay& replay, RealScore* score) {
  constexpr double kSettled = 1.0;   // after the last motion [s]
  constexpr double kShortest = 2.0;  // shortest rest to measure creep [s]
  const Time rest = motion_of(recording.data).end + from_seconds(kSettled);
  std::vector<double> heights;
  for (const RecordedStep& step : replay.steps) {
    if (step.state.time >= rest) heights.push_back(step.state.p_WB.z());
  }
  const RecordedStep& last = replay.steps.back();
  if (to_seconds(last.state.time - rest) < kShortest) return;
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  score->creep = *high - *low;
  score->creep_sigmas = score->creep / last.sigma_height();
}

}  // namespace

RealScore judge(const Recording& recording, const Replay& replay) {
  RealScore score;
  score.started =
      !replay.steps.empty() && replay.steps.front().state.time < motion_of(recording.data).end;
  const bool referenced = !recording.reference.empty();
  if (referenced) score.distance = length_of(recording.reference);
  if (!score.started) return score;
  const eval::Trajectory poses = poses_of(replay);
  if (!referenced) score.distance = length_of(poses);
  score.healthy = replay.healthy;
  score.farthest = 0.0;
  for (const auto& pose : poses) {
    score.farthest = std::max(score.farthest, (pose.p - poses.front().p).norm());
  }
  score.closure = (poses.back().p - poses.front().p).norm();
  const auto pitch = static_cast<std::size_t>(Calibration::kRotationY);
  score.pitch = replay.calibration[pitch].value;
  score.pitch_sigma = replay.calibration[pitch].sigma;
  if (referenced) judge_against_reference(recording.reference, poses, &score);
  judge_height(recording, replay, &score);
  judge_rest(recording, replay, &score);
  return score;
}

}  // namespace rio::experiment

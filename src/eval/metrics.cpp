// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace rio::eval {

namespace {

template <class Error>
AngleError angle_error(const std::vector<PosePair>& pairs, Error error) {
  if (pairs.empty()) return {};
  std::vector<double> magnitudes;
  magnitudes.reserve(pairs.size());
  for (const PosePair& pair : pairs) magnitudes.push_back(std::abs(error(pair)));
  const Statistics summary = statistics(std::move(magnitudes));
  return {summary.rmse, error(pairs.back()), summary.max};
}

}  // namespace

Statistics statistics(std::vector<double> values) {
  Statistics result;
  result.count = values.size();
  const auto nan =
      std::find_if(values.begin(), values.end(), [](double v) { return std::isnan(v); });
  if (values.empty() || nan != values.end()) return result;  // unknown
  const double n = static_cast<double>(values.size());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  result.mean = sum / n;
  result.rmse = std::sqrt(sum_of_squares / n);
  double deviations = 0.0;
  for (const double value : values) {
    deviations += (value - result.mean) * (value - result.mean);
  }
  result.std = std::sqrt(deviations / n);
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  result.median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  result.max = values.back();
  return result;
}

double wrapped(double degrees) {
  const double angle = std::remainder(degrees, 360.0);
  return angle == -180.0 ? 180.0 : angle;
}

double yaw_error(const PosePair& pair) {
  const Quaternion error = pair.estimate.q * pair.truth.q.conjugate();
  return wrapped(2.0 * kDegreesPerRadian * std::atan2(error.z(), error.w()));
}

double tilt_error(const Quaternion& estimate, const Quaternion& truth) {
  const Vector3d up = estimate.conjugate() * Vector3d::UnitZ();
  const Vector3d true_up = truth.conjugate() * Vector3d::UnitZ();
  return kDegreesPerRadian * std::atan2(up.cross(true_up).norm(), up.dot(true_up));
}

std::vector<double> path_distances(const std::vector<PosePair>& pairs) {
  std::vector<double> distances;
  distances.reserve(pairs.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i > 0) distance += (pairs[i].truth.p - pairs[i - 1].truth.p).norm();
    distances.push_back(distance);
  }
  return distances;
}

AbsoluteError absolute_error(const std::vector<PosePair>& pairs) {
  std::vector<double> translation;
  std::vector<double> rotation;
  for (const PosePair& pair : pairs) {
    translation.push_back((pair.estimate.p - pair.truth.p).norm());
    rotation.push_back(rotation_angle(pair.estimate.q * pair.truth.q.conjugate()));
  }
  return {statistics(std::move(translation)), statistics(std::move(rotation))};
}

RelativeError relative_error(const std::vector<PosePair>& pairs, double distance,
                             double tolerance) {
  const std::vector<double> path = path_distances(pairs);
  std::vector<double> translation;
  std::vector<double> drift;
  std::vector<double> rotation;
  std::vector<double> rotation_per_metre;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
    const auto first = path.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    const double target = path[i] + distance;
    auto end = std::lower_bound(first, path.end(), target);
    if (end == path.end() || (end != first && target - *std::prev(end) <= *end - target)) {
      // of poses at one position, as in hover, the first
      end = std::lower_bound(first, end, *std::prev(end));
    }
    const double length = *end - path[i];
    if (std::abs(length - distance) > tolerance * distance || length <= 0.0) continue;
    const PosePair& from = pairs[i];
    const PosePair& to = pairs[static_cast<std::size_t>(end - path.begin())];
    const Vector3d true_step = from.truth.q.conjugate() * (to.truth.p - from.truth.p);
    const Vector3d step = from.estimate.q.conjugate() * (to.estimate.p - from.estimate.p);
    const Quaternion true_turn = from.truth.q.conjugate() * to.truth.q;
    const Quaternion turn = from.estimate.q.conjugate() * to.estimate.q;
    translation.push_back((step - true_step).norm());  // (E2): a rotation does not change the norm
    rotation.push_back(rotation_angle(true_turn.conjugate() * turn));
    drift.push_back(100.0 * translation.back() / length);
    rotation_per_metre.push_back(rotation.back() / length);
  }
  return {distance, statistics(std::move(translation)), statistics(std::move(drift)),
          statistics(std::move(rotation)), statistics(std::move(rotation_per_metre))};
}

double norm_of_mae(const std::vector<PosePair>& pairs, double distance) {
  if (pairs.empty()) return kNan;
  const std::vector<double> path = path_distances(pairs);
  if (path.back() < distance) return kNan;
  Vector3d sum = Vector3d::Zero();
  double n = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (path[i] > distance) break;
    sum += (pairs[i].estimate.p - pairs[i].truth.p).cwiseAbs();
    n += 1.0;
  }
  return (sum / n).norm();
}

double final_drift(const std::vector<PosePair>& pairs) {
  const double length = path_length(pairs);
  if (!(length > 0.0)) return kNan;
  return 100.0 * (pairs.back().estimate.p - pairs.back().truth.p).norm() / length;
}

AngleError yaw_errors(const std::vector<PosePair>& pairs) {
  return angle_error(pairs, yaw_error);
}

AngleError tilt_errors(const std::vector<PosePair>& pairs) {
  return angle_error(pairs, [](const PosePair& pair) { return tilt_error(pair); });
}

}  // namespace rio::eval

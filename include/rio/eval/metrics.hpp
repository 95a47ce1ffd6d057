// SPDX-License-Identifier: BSD-3-Clause
// Errors of an estimated trajectory against the truth, over associated (and perhaps aligned) pairs.
//
// (E1) absolute:  dp_i = p_est - p_true,  E_i = R_est R_true^T (world axes)
// (E2) relative:  E_ij = (T_true,i^-1 T_true,j)^-1 (T_est,i^-1 T_est,j) over a piece of the true
// path (E3) norm of MAE = |mean |dp||,  norm of RMSE = |sqrt(mean dp^2)|, both taken per axis first
// (E4) yaw error = twist of E_i about z;  tilt = angle between R_est^T e_z and R_true^T e_z
// Metres and degrees; NaN where there is nothing to measure.
// Reference: Sturm et al., 2012 (APE, RPE); Michalczyk et al., ICRA 2023, IV.B (norm of MAE, final
// drift); Michalczyk et al., IROS 2024, IV.B (norm of RMSE).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/eval/association.hpp"

namespace rio::eval {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kDegreesPerRadian = 57.295779513082321;

/// Summary of a list of numbers; all NaN if it is empty.
struct Statistics {
  std::size_t count = 0;
  double rmse = kNan;
  double mean = kNan;
  double median = kNan;
  double max = kNan;
  double std = kNan;  ///< of the population (divides by count)
};

inline Statistics statistics(std::vector<double> values) {
  Statistics result;
  result.count = values.size();
  if (values.empty()) return result;
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

/// Angle of a rotation [deg], 0 to 180.
inline double rotation_angle(const Quaternion& q) {
  return kDegreesPerRadian * quaternion_log(q).norm();
}

/// Angle in (-180, 180] that differs from `degrees` by whole turns.
inline double wrapped(double degrees) {
  const double angle = std::remainder(degrees, 360.0);
  return angle == -180.0 ? 180.0 : angle;
}

/// Yaw of the estimate minus that of the truth (E4) [deg], in (-180, 180].
inline double yaw_error(const PosePair& pair) {
  const Quaternion error = pair.estimate.q * pair.truth.q.conjugate();
  return wrapped(2.0 * kDegreesPerRadian * std::atan2(error.z(), error.w()));
}

/// Angle between the gravity directions of estimate and truth (E4) [deg], 0 to 180.
inline double tilt_error(const PosePair& pair) {
  const Vector3d estimate = pair.estimate.q.conjugate() * Vector3d::UnitZ();
  const Vector3d truth = pair.truth.q.conjugate() * Vector3d::UnitZ();
  return kDegreesPerRadian * std::atan2(estimate.cross(truth).norm(), estimate.dot(truth));
}

/// Distance travelled by the truth up to each pair [m]: straight lines between the pairs.
inline std::vector<double> path_distances(const std::vector<PosePair>& pairs) {
  std::vector<double> distances;
  distances.reserve(pairs.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i > 0) distance += (pairs[i].truth.p - pairs[i - 1].truth.p).norm();
    distances.push_back(distance);
  }
  return distances;
}

/// Length of the true path [m]; 0 without pairs.
inline double path_length(const std::vector<PosePair>& pairs) {
  return pairs.empty() ? 0.0 : path_distances(pairs).back();
}

/// Absolute pose error (E1).
struct AbsoluteError {
  Statistics translation;  ///< |dp| [m]
  Statistics rotation;     ///< angle of E [deg]
};

inline AbsoluteError absolute_error(const std::vector<PosePair>& pairs) {
  std::vector<double> translation;
  std::vector<double> rotation;
  for (const PosePair& pair : pairs) {
    translation.push_back((pair.estimate.p - pair.truth.p).norm());
    rotation.push_back(rotation_angle(pair.estimate.q * pair.truth.q.conjugate()));
  }
  return {statistics(std::move(translation)), statistics(std::move(rotation))};
}

/// Relative pose error (E2) over pieces of the true path of nearly `distance` metres.
struct RelativeError {
  double distance = 0.0;          ///< asked for [m]
  Statistics translation;         ///< [m]
  Statistics drift;               ///< translation over the length of the piece [%]
  Statistics rotation;            ///< [deg]
  Statistics rotation_per_metre;  ///< [deg/m]
};

/// As evo with all pairs: from every pose to the pose whose distance along the true path is nearest
/// to `distance` [m]; pieces off by more than `tolerance` x distance are left out.
inline RelativeError relative_error(const std::vector<PosePair>& pairs, double distance,
                                    double tolerance = 0.1) {
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
      // of poses at one place, as while hovering, the first
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

/// Norm of the mean absolute error of position (E3) [m], over the pairs until the true path is
/// `distance` metres long; NaN if it never gets there. Without `distance`: over all pairs.
inline double norm_of_mae(const std::vector<PosePair>& pairs, double distance = kNan) {
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

/// Norm of the root mean square error of position (E3) [m]; equals the RMSE of |dp|.
inline double norm_of_rmse(const std::vector<PosePair>& pairs) {
  return absolute_error(pairs).translation.rmse;
}

/// |dp| at the last pair over the length of the true path [%]; NaN if that is 0.
inline double final_drift(const std::vector<PosePair>& pairs) {
  const double length = path_length(pairs);
  if (!(length > 0.0)) return kNan;
  return 100.0 * (pairs.back().estimate.p - pairs.back().truth.p).norm() / length;
}

/// An angle error over time [deg].
struct AngleError {
  double rmse = kNan;
  double final = kNan;  ///< at the last pair, with its sign
  double max = kNan;    ///< largest magnitude
};

namespace metrics_detail {

template <class Error>
AngleError angle_error(const std::vector<PosePair>& pairs, Error error) {
  if (pairs.empty()) return {};
  std::vector<double> magnitudes;
  magnitudes.reserve(pairs.size());
  for (const PosePair& pair : pairs) magnitudes.push_back(std::abs(error(pair)));
  const Statistics summary = statistics(std::move(magnitudes));
  return {summary.rmse, error(pairs.back()), summary.max};
}

}  // namespace metrics_detail

/// Yaw error over all pairs (E4).
inline AngleError yaw_errors(const std::vector<PosePair>& pairs) {
  return metrics_detail::angle_error(pairs, yaw_error);
}

/// Tilt error over all pairs (E4).
inline AngleError tilt_errors(const std::vector<PosePair>& pairs) {
  return metrics_detail::angle_error(pairs, tilt_error);
}

}  // namespace rio::eval

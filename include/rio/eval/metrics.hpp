// SPDX-License-Identifier: BSD-3-Clause
// Errors of an estimated trajectory against the truth, over associated (optionally aligned) pairs.
//
// (E1) absolute:  dp_i = p_est - p_true,  E_i = R_est R_true^T (world axes)
// (E2) relative:  E_ij = (T_true,i^-1 T_true,j)^-1 (T_est,i^-1 T_est,j), i to j a segment of the
//      true path
// (E3) norm of MAE = |mean |dp||,  norm of RMSE = |sqrt(mean dp^2)|, both taken per axis first
// (E4) yaw error = twist of E_i about z;  tilt = angle between R_est^T e_z and R_true^T e_z
// Metres and degrees; NaN if there is no data. Reference: Sturm et al., 2012 (APE, RPE); Michalczyk
// et al., ICRA 2023, IV.B (norm of MAE, final drift) and IROS 2024, IV.B (norm of RMSE).
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/eval/pairing.hpp"

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

Statistics statistics(std::vector<double> values);

/// Angle of a rotation [deg], 0 to 180.
inline double rotation_angle(const Quaternion& q) {
  return kDegreesPerRadian * quaternion_log(q).norm();
}

/// Angle in (-180, 180] that differs from `degrees` by whole turns.
double wrapped(double degrees);

/// Yaw of the estimate minus that of the truth (E4) [deg], in (-180, 180].
double yaw_error(const PosePair& pair);

/// Angle between the gravity directions of estimate and truth (E4) [deg], 0 to 180.
double tilt_error(const Quaternion& estimate, const Quaternion& truth);
inline double tilt_error(const PosePair& pair) {
  return tilt_error(pair.estimate.q, pair.truth.q);
}

/// Distance travelled by the truth up to each pair [m]: straight lines between the pairs.
std::vector<double> path_distances(const std::vector<PosePair>& pairs);

/// Length of the true path [m]; 0 without pairs.
inline double path_length(const std::vector<PosePair>& pairs) {
  return pairs.empty() ? 0.0 : path_distances(pairs).back();
}

/// Absolute pose error (E1).
struct AbsoluteError {
  Statistics translation;  ///< |dp| [m]
  Statistics rotation;     ///< angle of E [deg]
};

AbsoluteError absolute_error(const std::vector<PosePair>& pairs);

/// Relative pose error (E2) over segments of the true path of about `distance` metres.
struct RelativeError {
  double distance = 0.0;          ///< as requested [m]
  Statistics translation;         ///< [m]
  Statistics drift;               ///< translation over the length of the segment [%]
  Statistics rotation;            ///< [deg]
  Statistics rotation_per_metre;  ///< [deg/m]
};

/// As evo with all pairs: from every pose to the pose whose distance along the true path is nearest
/// to `distance` [m]; segments off by more than `tolerance` x distance are dropped.
RelativeError relative_error(const std::vector<PosePair>& pairs, double distance,
                             double tolerance = 0.1);

/// Norm of the mean absolute error of position (E3) [m], over the pairs until the true path is
/// `distance` metres long; NaN if it is shorter. Without `distance`: over all pairs.
double norm_of_mae(const std::vector<PosePair>& pairs, double distance = kNan);

/// Norm of the root mean square error of position (E3) [m]; equals the RMSE of |dp|.
inline double norm_of_rmse(const std::vector<PosePair>& pairs) {
  return absolute_error(pairs).translation.rmse;
}

/// |dp| at the last pair over the length of the true path [%]; NaN if that is 0.
double final_drift(const std::vector<PosePair>& pairs);

/// An angle error over time [deg].
struct AngleError {
  double rmse = kNan;
  double final = kNan;  ///< at the last pair, signed
  double max = kNan;    ///< largest magnitude
};

/// Yaw error over all pairs (E4).
AngleError yaw_errors(const std::vector<PosePair>& pairs);

/// Tilt error over all pairs (E4).
AngleError tilt_errors(const std::vector<PosePair>& pairs);

}  // namespace rio::eval

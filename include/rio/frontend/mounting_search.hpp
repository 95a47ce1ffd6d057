// SPDX-License-Identifier: BSD-3-Clause
// Stage 2 while the mounting of a radar is unknown: finds T_BS from the velocities that its scans
// show and those that the IMU integrates, before the first Doppler is used.
//
// (E1) R_BS v_S = R_BW (v + d) + w x p, v the velocity integrated from the IMU, d its error.
// (E2) e' = d, d' = a, a' = 0: error of the position, and what tilt and accelerometer bias cause;
//      with the noise of the accelerometer, and its bias turning with the heading.
// (E3) With x = (vec R_BS, 1, p, e, d, a) the residual of (E1) is linear, A x: the evidence is a
//      sum M = sum w A^T A, an information matrix. (E2) is its time update, and eliminates the
//      past.
// (E4) w^-1 = tr(Sigma_v) / 3 + (kLasting |v|)^2 T / dt: white noise of the consensus, and an error
//      of the directions that a scene keeps for T, so that many scans do not average it away; |v|
//      by the IMU.
// (E5) Without p, e, d, a it is a quadratic form of vec R on SO(3): Levenberg-Marquardt from 24
//      rotations by right angles, R <- R Exp(phi). Of minima that the evidence does not tell
//      apart, the one nearest to the configured mounting.
// A vehicle that only drives ahead never shows the rotation about its way: after kPatience of
// motion, later in a climb, it is taken from the configured mounting, with the sigma kLinear.
// Derivation: data/theory.md, 12. Reference for (E5): Wahba 1965, problem 65-1.
#pragma once

#include <optional>

#include "rio/frontend/ego_velocity.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"
#include "rio/types.hpp"

namespace rio {

/// Pose of a radar in the body frame, and what its scans have shown of the motion meanwhile.
struct Mounting {
  Pose T_BS;
  Vector3d position_error_W = Vector3d::Zero();  ///< true minus integrated [m]
  Vector3d velocity_error_W = Vector3d::Zero();  ///< same [m/s]
  /// Joint: rotation, R <- R Exp(phi), axes S [rad]; translation, axes B [m]; position; velocity.
  Eigen::Matrix<double, 12, 12> covariance = Eigen::Matrix<double, 12, 12>::Zero();
};

/// No allocation after construction; the scans are a sum of constant size.
class MountingSearch {
 public:
  // x of (E3)
  static constexpr int kRotation = 0;
  static constexpr int kOne = 9;
  static constexpr int kLever = 10;
  static constexpr int kKept = 13;
  static constexpr int kDrift = 9;  // e, d, a
  static constexpr int kVelocity = kKept + 3;
  static constexpr int kSize = kKept + kDrift;
  /// Up to M; one type, because each size of Eigen's solvers costs a second of compile time.
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kSize, kSize>;

  /// @param options of the radar (Options::seen_by)
  explicit MountingSearch(const Options& options);

  /// The mounting is too uncertain for linearised updates.
  static bool is_unknown(const CalibrationOptions& calibration) {
    constexpr double kUnknown = 1.0;  // sine and angle differ by 16 % [rad]
    return calibration.rotation_sigma > kUnknown;
  }

  void reset();

  /// The IMU velocity has been corrected or has jumped: (E2) starts over, what it showed is kept.
  void restart_drift();

  /// Takes a scan that is not corrected for anything; the mounting once it is known.
  /// @param x predicted by the IMU to the time of the scan, @param P its covariance
  std::optional<Mounting> add(const DetectionList& scan, const Estimate& x,
                              const BodyCovariance& P);

 private:
  /// (E2) to the time of x, from the prior P if it starts over. The time since the last scan [s].
  double advance(const Estimate& x, const BodyCovariance& P);
  /// (E3) with the velocity of the scan.
  void accumulate(const RadarVelocity& velocity, const Estimate& x, double dt);
  std::optional<Mounting> solve(const Matrix3d& R_WB) const;

  Pose configured_;
  CalibrationOptions priors_;
  double gravity_;
  double doppler_scale_;
  EgoVelocityRansac ransac_;
  EgoVelocity velocity_;      ///< of the last scan
  Block sum_;                 ///< M, with the prior of p
  std::optional<Time> last_;  ///< time of e, d, a; none: they start over
  double expected_ = 0.0;     ///< sum of squares by (E4)
  double motion_ = 0.0;       ///< time in motion so far [s]
  double solved_ = 0.0;       ///< of it at the last solution [s]
};

}  // namespace rio

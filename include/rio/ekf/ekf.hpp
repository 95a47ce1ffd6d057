// SPDX-License-Identifier: BSD-3-Clause
// Back-end 1: the multi-state error-state Kalman filter (Michalczyk et al., ICRA 2023).
//
// The rows of one scan are linearised at the predicted state, gated with the predicted covariance,
// and applied at once; the corrected pose is kept as a clone (stochastic cloning).
#pragma once

#include "rio/ekf/panel_update.hpp"
#include "rio/ekf/reexpression.hpp"
#include "rio/ekf/row_compression.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/update/landmark_policy.hpp"
#include "rio/update/scan_rows.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

class Ekf {
 public:
  explicit Ekf(const Options& options);

  const Estimate& estimate() const { return state_estimate_.estimate(); }
  const StateEstimate& state_estimate() const { return state_estimate_; }
  /// New landmarks that can be taken (update/landmark_policy.hpp).
  std::size_t landmark_room(const Observations& seen) const {
    return rio::landmark_room(estimate(), seen, options_);
  }

  /// Starts over from `prior` with covariance P0, order of namespace body.
  void reset(const NavState& prior, const BodyCovariance& P0);

  /// Stage 1: to exactly `to`. kNumerical, with nothing changed, if the result is not finite.
  Status propagate(Time to, const ImuBuffer& imu, bool* gap) {
    return state_estimate_.propagate(to, imu, gap);
  }

  /// A scan of radar r is processed next.
  void select_radar(std::size_t r) { state_estimate_.select_radar(r); }

  /// Time of the state that keeps an aiding measurement; the filter keeps none.
  Time anchor(Time /*measured*/) const { return estimate().nav.time; }

  /// Removes all landmarks.
  void drop_landmarks(UpdateReport* report);

  /// Replaces the velocity by v_B [m/s, body axes], wrong for `duration` [s] and possibly for
  /// `doubtful` [s] (update/state_estimate.hpp). Drops all landmarks; the caller drops the trails.
  void restart_velocity(const Vector3d& v_B, const Matrix3d& covariance_B, double duration,
                        double doubtful, UpdateReport* report);

  /// Replaces the tilt so that gravity is g_B, sigma per axis [m/s^2], wrong for `duration` [s], at
  /// the velocity v_B [m/s], both in body axes (update/state_estimate.hpp).
  void restart_attitude(const Vector3d& g_B, double sigma, const Vector3d& v_B, double duration) {
    state_estimate_.restart_attitude(g_B, sigma, v_B, duration);
  }

  /// The static alignment was of a body in motion of that speed [m/s] (update/state_estimate.hpp).
  void withdraw_alignment(double speed) { state_estimate_.withdraw_alignment(speed); }

  /// Inflates the covariance of gyro bias about the vertical and heading. Drops all landmarks; the
  /// caller drops the trails.
  void restart_heading(const GyroBiasOpinion& opinion, UpdateReport* report) {
    drop_landmarks(report);
    state_estimate_.restart_heading(opinion);
  }

  /// Inflates the covariance of the position by sigma per axis [m]. Drops all landmarks, which such
  /// a position would mismatch; the caller drops the trails.
  void reopen_position(double sigma, UpdateReport* report) {
    drop_landmarks(report);
    state_estimate_.reopen_position(sigma);
  }

  /// Stages 4 to 6. kNumerical, with state and covariance as predicted, if the update fails.
  Status update(const Observations& seen, UpdateReport* report);

  /// Stage 7 (update/landmark_policy.hpp).
  void maintain_landmarks(const Observations& seen, const Promotions& promotions,
                          UpdateReport* report);

  /// Stage 2: the corrected pose becomes the clone of this scan, in place of the oldest one of its
  /// radar.
  void clone(ScanId scan) { state_estimate_.clone(scan); }

 private:
  Options options_;
  StateEstimate state_estimate_;
  Estimate before_;
  ScanRows rows_;
  RowCompression compression_;
  PanelUpdate panels_;
  Reexpression reexpression_;
  Eigen::VectorXd dx_;
};

}  // namespace rio

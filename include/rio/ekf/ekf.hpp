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
#include "rio/update/back_end.hpp"
#include "rio/update/landmark_policy.hpp"
#include "rio/update/scan_rows.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

class Ekf {
 public:
  explicit Ekf(const Options& options);

  const Estimate& estimate() const { return state_estimate_.estimate(); }
  const StateEstimate& state_estimate() const { return state_estimate_; }

  /// Starts over from `prior` with covariance P0, order of namespace body.
  void reset(const NavState& prior, const BodyCovariance& P0) { state_estimate_.reset(prior, P0); }

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

  /// A check replaces a part of the state: change(StateEstimate*) (checks/replacements.hpp).
  template <class Change>
  void replace(const Change& change, Invalidates also, UpdateReport* report) {
    if (also == Invalidates::kLandmarks) drop_landmarks(report);
    change(&state_estimate_);
  }

  /// Stage 5. kNumerical, with state and covariance as predicted, if the update fails.
  Status update(const Observations& seen, const ScanRows& rows);

  /// Stage 6 (update/landmark_policy.hpp).
  void maintain_landmarks(const Observations& seen, const ScanRows& rows,
                          const Promotions& promotions, UpdateReport* report);

  /// Stage 7: the corrected pose becomes the clone of this scan, in place of the oldest one of its
  /// radar.
  void clone(ScanId scan) { state_estimate_.clone(scan); }

 private:
  Options options_;
  StateEstimate state_estimate_;
  Estimate before_;
  RowCompression compression_;
  PanelUpdate panels_;
  Reexpression reexpression_;
  Eigen::VectorXd dx_;
};

}  // namespace rio

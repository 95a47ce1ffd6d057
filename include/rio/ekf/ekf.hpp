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

/// The members are those of the contract of a back-end (update/back_end.hpp).
class Ekf {
 public:
  explicit Ekf(const Options& options);

  const Estimate& estimate() const { return state_estimate_.estimate(); }
  const StateEstimate& state_estimate() const { return state_estimate_; }

  void reset(const NavState& prior, const BodyCovariance& P0) { state_estimate_.reset(prior, P0); }
  Status propagate(Time to, const ImuBuffer& imu, bool* gap) {
    return state_estimate_.propagate(to, imu, gap);
  }
  void select_radar(std::size_t r) { state_estimate_.select_radar(r); }
  /// The filter keeps no measurement of an earlier time.
  Time anchor(Time /*measured*/) const { return estimate().nav.time; }
  void drop_landmarks(UpdateReport* report);
  template <class Change>
  void replace(const Change& change, Invalidates also, UpdateReport* report) {
    if (also == Invalidates::kLandmarks) drop_landmarks(report);
    change(&state_estimate_);
  }
  Status update(const Observations& seen, const ScanRows& rows);
  void maintain_landmarks(const Observations& seen, const ScanRows& rows,
                          const Promotions& promotions, UpdateReport* report);
  /// The corrected pose becomes the clone of this scan, in place of the oldest one of its
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

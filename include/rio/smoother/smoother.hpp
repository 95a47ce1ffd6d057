// SPDX-License-Identifier: BSD-3-Clause
// Back-end 2: a fixed-lag smoother, a sliding window of states at the last scans that is optimised
// with each scan (Michalczyk et al., IROS 2024). Same front-end, models and gates as the filter.
//
// A new state is predicted by the IMU from the last solution (state_estimate_) and its measurements
// are gated there; then Gauss-Newton over [states | calibration, auxiliary, landmarks] minimises
//   prior + preintegrated IMU + all measurements of the window, robust kernels included,
// and the oldest state is marginalised into the prior. The tail of the factorisation gives the
// joint covariance of the newest state and the border: the state estimate for the next scan.
#pragma once

#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/smoother/gauss_newton.hpp"
#include "rio/smoother/normal_equations.hpp"
#include "rio/smoother/preintegration.hpp"
#include "rio/smoother/prior.hpp"
#include "rio/smoother/window.hpp"
#include "rio/smoother/window_factors.hpp"
#include "rio/update/back_end.hpp"
#include "rio/update/landmark_policy.hpp"
#include "rio/update/scan_rows.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

/// The members are those of the contract of a back-end (update/back_end.hpp).
class Smoother {
 public:
  Smoother(const Smoother&) = delete;  // a copy would lose the storage set aside
  Smoother& operator=(const Smoother&) = delete;
  explicit Smoother(const Options& options);

  const Estimate& estimate() const { return state_estimate_.estimate(); }
  const StateEstimate& state_estimate() const { return state_estimate_; }
  const Window& window() const { return window_; }
  const Prior& prior() const { return prior_; }

  void reset(const NavState& prior, const BodyCovariance& P0) {
    state_estimate_.reset(prior, P0);
    restart();
  }
  Status propagate(Time to, const ImuBuffer& imu, bool* gap);
  void select_radar(std::size_t r) { state_estimate_.select_radar(r); }
  /// The first state not before the measurement keeps it.
  Time anchor(Time measured) const;
  void drop_landmarks(UpdateReport* report);
  /// The window starts over from the result.
  template <class Change>
  void replace(const Change& change, Invalidates also, UpdateReport* report) {
    if (also == Invalidates::kLandmarks) drop_landmarks(report);
    change(&state_estimate_);
    restart();
  }
  Status update(const Observations& seen, const ScanRows& rows);
  /// A new landmark is measured once, by the newest state.
  void maintain_landmarks(const Observations& seen, const ScanRows& rows,
                          const Promotions& promotions, UpdateReport* report);
  /// Assigns this scan to the newest state.
  void clone(ScanId scan) {
    window_.newest().scan = scan;
    window_.publish(&state_estimate_.estimate());
  }

 private:
  /// States of the window, one of them about to be marginalised.
  static int capacity(const Options& options) { return options.smoother.window + 1; }
  /// Calibration, auxiliary states and landmarks.
  int border_capacity() const { return state_estimate_.layout().capacity() - body::kSize; }

  /// Starts over with one state, the state estimate's; its covariance becomes the prior.
  void restart();

  /// Appends the predicted state. False, with nothing changed, if there is no valid IMU factor.
  bool append();
  void copy_newest();

  /// Measurements that passed the gates become factors of the newest state, aiding measurements
  /// also of earlier ones.
  void take(const Observations& seen, const ScanRows& rows);

  /// Optimises; the result is in the state estimate and the window.
  bool solve();

  /// Begins the system at the current point; returns the cost of the prior.
  double begin_with_prior();

  /// Marginalises the oldest state: all factors that touch it become the prior of the others.
  bool marginalise_oldest();

  /// Marginalises landmark i in the prior and drops its factors; the last one takes its place.
  void remove_landmark(std::size_t i);

  static constexpr double kExact = 1e-5;  // sigma treated as exactly known, SI units

  Options options_;
  StateEstimate state_estimate_;
  Window window_;
  NormalEquations system_;
  Prior prior_;
  WindowFactors factors_;
  GaussNewton solver_;
  Preintegration since_;  ///< since the newest state of the window
  WindowPoint before_;
  StaticVector<std::vector<AidingFactor>*, kMaxAiding> aided_;  ///< where take() added a factor
  int since_considered_ = 0;  ///< states marginalised since Prior::consider()
  Eigen::VectorXd g_;
  Eigen::MatrixXd A_;
  Eigen::MatrixXd P_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Back-end 1: the multi-state error-state Kalman filter (Michalczyk et al., ICRA 2023).
//
// The rows of one scan are linearised at the predicted state, gated against the predicted
// covariance, and applied at once; the corrected pose is kept as a clone.
#pragma once

#include "rio/ekf/panel_update.hpp"
#include "rio/ekf/reexpression.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/update/belief.hpp"
#include "rio/update/landmark_policy.hpp"
#include "rio/update/scan_rows.hpp"

namespace rio {

class Ekf {
 public:
  explicit Ekf(const Options& options)
      : options_(options),
        belief_(options, options.update.max_clones),
        rows_(options),
        panels_(belief_.layout().capacity()),
        dx_(Eigen::VectorXd::Zero(belief_.layout().capacity())) {}

  const Estimate& estimate() const { return belief_.estimate(); }
  const Belief& belief() const { return belief_; }
  /// New landmarks that can be taken (update/landmark_policy.hpp).
  std::size_t landmark_room(const Observations& seen) const {
    return rio::landmark_room(estimate(), seen, options_);
  }

  void reset(const NavState& prior, const BodyCovariance& P0) {
    belief_.reset(prior, P0);
    rows_.reset();
  }

  /// Stage 1: to exactly `to`. kNumerical, with nothing changed, if the result is not finite.
  Status propagate(Time to, const ImuBuffer& imu, bool* gap) {
    return belief_.propagate(to, imu, gap);
  }

  /// All landmarks leave.
  void drop_landmarks(UpdateReport* report) {
    for (std::size_t i = estimate().landmarks.size(); i-- > 0;) {
      belief_.remove_landmark(i);
      ++report->landmarks_removed;
    }
  }

  /// The velocity has been off by about `error` [m/s] for `duration` [s]: P admits it, and the
  /// landmarks seen meanwhile are dropped. The trails have to go, too.
  void reopen_velocity(double error, double duration, UpdateReport* report) {
    drop_landmarks(report);
    belief_.covariance().reopen_velocity(error * error, duration);
  }

  /// Stages 4 to 6. kNumerical, with state and covariance as predicted, if the update fails.
  Status update(const Observations& seen, UpdateReport* report) {
    const RowBatch& rows = rows_.build(seen, belief_, report);
    if (!panels_.apply(rows, &belief_.covariance(), &dx_)) return Status::kNumerical;
    before_ = belief_.estimate();
    belief_.correct(dx_);
    if (options_.update.consistent_covariance) {
      reexpress(belief_.layout(), before_, belief_.estimate(), &belief_.covariance());
    }
    return Status::kOk;
  }

  /// Stage 7 (update/landmark_policy.hpp).
  void maintain_landmarks(const Observations& seen, const Promotions& promotions,
                          UpdateReport* report) {
    rio::maintain_landmarks(
        seen, rows_, promotions, options_, &belief_.estimate(), report,
        [this](std::size_t i) { belief_.remove_landmark(i); },
        [this](const Detection& d) { belief_.add_landmark(d); });
  }

  /// Stage 2: the corrected pose becomes the clone of this scan, in place of the oldest one.
  void clone(ScanId scan) { belief_.clone(scan); }

 private:
  Options options_;
  Belief belief_;
  Estimate before_;
  ScanRows rows_;
  PanelUpdate panels_;
  Eigen::VectorXd dx_;
};

}  // namespace rio

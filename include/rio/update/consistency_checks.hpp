// SPDX-License-Identifier: BSD-3-Clause
// The independent checks of the estimate, and what they replace in it. Each contradicts the state
// estimate only after consistent evidence of some time; what it contradicts is replaced or its
// covariance inflated, and the landmarks, which agree with the old state, are dropped.
//
//   velocity        frontend/velocity_pool.hpp      before association, which needs the velocity
//   tilt            frontend/gravity_check.hpp      after it: the check uses the static set
//   gyro bias about the vertical, heading           after the update, whose corrections it sums:
//                   update/gyro_bias_check.hpp
//   position        update/doubtful_interval.hpp    same: it counts what the update gates
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "rio/core/so3.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/frontend/gravity_check.hpp"
#include "rio/frontend/velocity_pool.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/report.hpp"
#include "rio/update/doubtful_interval.hpp"
#include "rio/update/gyro_bias_check.hpp"
#include "rio/update/health_monitor.hpp"

namespace rio {

/// Every check_...() is called once per scan, in this order, and returns whether it changed the
/// state estimate: the caller's trails are void then. No allocation after construction.
template <class BackEnd>
class ConsistencyChecks {
 public:
  /// @param backend checked and corrected; it and the report must outlive the checks
  ConsistencyChecks(const Options& options, BackEnd* backend, UpdateReport* report)
      : enabled_(options.frontend.velocity_recovery),
        backend_(*backend),
        report_(*report),
        pool_(options),
        gravity_(options),
        gyro_bias_(options) {}

  /// The back-end starts over at `time`.
  /// @param unconfirmed from a static alignment: the body may have been in motion
  void reset(Time time, bool unconfirmed) {
    pool_.reset(time);
    gravity_.reset(time);
    gyro_bias_.reset();
    doubtful_.reset();
    replaced_.reset();
    unconfirmed_alignment_ = unconfirmed;
  }

  /// Sigma of roll and pitch together [rad].
  double sigma_tilt() const {
    const BodyCovariance P = body_covariance();
    return std::sqrt(attitude_variance(backend_.estimate().nav.q_WB,
                                       P.block<3, 3>(body::kAttitude, body::kAttitude))
                         .tilt);
  }

  /// The tilt is too uncertain for a linearised update. False if the checks are switched off:
  /// updates then continue.
  bool tilt_is_lost() const {
    constexpr double kLinear = 0.35;  // 1 - cos is 6 % [rad]
    return enabled_ && sigma_tilt() > kLinear;
  }

  /// The state was propagated from `last`; the buffer holds the samples since.
  /// @param gap the IMU paused since
  void carry(Time last, const ImuBuffer& imu, bool gap) {
    if (!enabled_) return;
    pool_.carry(backend_.estimate(), last, imu, gap);
    gravity_.carry(backend_.estimate(), last, imu, gap);
  }

  /// @param scan corrected for the errors of the radar
  /// @param velocity_covariance of the predicted radar velocity
  /// @param last time of the scan before
  [[nodiscard]] bool check_velocity(const DetectionList& scan, const Matrix3d& velocity_covariance,
                                    Time last) {
    constexpr double kOpen = 0.5;  // above it the next scans determine the velocity [m/s]
    const Estimate& x = backend_.estimate();
    sigma_velocity_ = std::sqrt(velocity_covariance.trace());
    const auto other = pool_.observe(scan, x, sigma_velocity_, sigma_tilt());
    report_.velocity_reset = other.has_value();
    report_.velocity_contradicted = to_seconds(x.nav.time - pool_.contradicted_since());
    if (pool_.proven()) unconfirmed_alignment_ = false;
    if (!other) {
      if (sigma_velocity_ > kOpen) replaced_ = Replaced{x.nav.time, last};
      return false;
    }
    if (unconfirmed_alignment_) backend_.withdraw_alignment(other->v_B.norm());
    unconfirmed_alignment_ = false;
    restart_velocity(*other, to_seconds(x.nav.time - pool_.agreed()), doubtful_since());
    return true;
  }

  /// Most of the static set may be movers.
  bool consensus_is_doubtful() const {
    constexpr double kMost = 0.4;  // share of the rows that agree by chance
    return pool_.chance() > kMost;
  }

  /// @param seen observations of the scan: its static set
  [[nodiscard]] bool check_tilt(const Observations& seen) {
    const Estimate& x = backend_.estimate();
    const auto down = gravity_.observe(seen, x, body_covariance(),
                                       backend_.state_estimate().velocity_calibration());
    report_.attitude_reset = down.has_value();
    report_.tilt_contradicted =
        to_seconds(x.nav.time - gravity_.contradicted_since().value_or(x.nav.time));
    if (!down) return false;
    const Time since = std::min(gravity_.agreed(), pool_.agreed());
    backend_.restart_attitude(down->g_B, down->sigma, down->velocity.v_B,
                              to_seconds(x.nav.time - since));
    restart_velocity(down->velocity, 0.0, since);  // the velocity diverged gradually
    gravity_.reset(x.nav.time);
    gyro_bias_.reset();
    return true;
  }

  /// Call before the update, with the predicted state in the back-end.
  void predicted() { gyro_bias_.predicted(backend_.estimate(), body_covariance()); }

  [[nodiscard]] bool check_gyro_bias() {
    const auto opinion = gyro_bias_.corrected(backend_.estimate(), body_covariance());
    if (!opinion) return false;
    backend_.restart_heading(*opinion, &report_);
    report_.attitude_reset = true;
    gyro_bias_.reset();
    return true;
  }

  /// @param health after the scan before
  /// @param seconds since that
  [[nodiscard]] bool check_position(const HealthMonitor& health, double seconds) {
    if (!enabled_) return false;
    const bool outliers = health.health().because(HealthReason::kOutliers);
    const double sigma = doubtful_.observe({.contradiction = pool_.contradiction(),
                                            .gated = health.unusual_gated_share(),
                                            .sigma = outliers ? sigma_velocity_ : 0.0},
                                           seconds);
    report_.position_reopened = sigma;
    if (sigma == 0.0) return false;
    backend_.reopen_position(sigma, &report_);
    return true;
  }

 private:
  /// A replacement of the velocity, by a check or by scans after it had become uncertain.
  struct Replaced {
    Time at{0};
    Time since{0};  ///< when the replaced velocity may have become wrong
  };

  BodyCovariance body_covariance() const { return backend_.state_estimate().covariance().body(); }

  /// Since when the velocity may have been wrong: one that replaced another recently and is now
  /// contradicted may have been wrong from the start, however well the scans supported it.
  Time doubtful_since() const {
    constexpr Time kLong = std::chrono::seconds(30);  // crowds and multipath are shorter
    const bool again = replaced_ && backend_.estimate().nav.time - replaced_->at < kLong;
    return again ? std::min(replaced_->since, pool_.agreed()) : pool_.agreed();
  }

  /// Replaces the velocity and drops the landmarks. The covariance of the position is inflated by
  /// the possible effect of the difference since `since`.
  void restart_velocity(const VelocityOpinion& other, double duration, Time since) {
    const Time now = backend_.estimate().nav.time;
    backend_.restart_velocity(other.v_B, other.covariance, duration, to_seconds(now - since),
                              &report_);
    replaced_ = Replaced{now, since};
    pool_.reset(now);
    doubtful_.reset();
  }

  bool enabled_;
  BackEnd& backend_;
  UpdateReport& report_;
  VelocityPool pool_;
  GravityCheck gravity_;
  GyroBiasCheck gyro_bias_;
  DoubtfulInterval doubtful_;
  std::optional<Replaced> replaced_;
  double sigma_velocity_ = 0.0;  ///< predicted, all axes [m/s]
  bool unconfirmed_alignment_ = false;
};

}  // namespace rio

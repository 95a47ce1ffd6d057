// SPDX-License-Identifier: BSD-3-Clause
// The checks of the estimate, each by evidence that the update does not use, and what they replace.
// All have one life cycle: they carry their evidence with the propagation, observe a scan, and act
// only if it has contradicted the estimate for long enough (checks/record.hpp). What is
// contradicted is replaced or its covariance inflated (checks/replacements.hpp); the landmarks,
// which agree with the old state, are dropped.
//
//   landmarks       silence, gaps, tilt             before the front-end, which matches them
//   velocity        checks/velocity_check.hpp       before association, which needs the velocity
//   tilt            checks/tilt_check.hpp           after it: the check uses the static set
//   heading, biases checks/correction_check.hpp     after the update, whose corrections it sums
//   position        checks/position_check.hpp       same: it counts what the update gates
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "rio/checks/correction_check.hpp"
#include "rio/checks/health_monitor.hpp"
#include "rio/checks/position_check.hpp"
#include "rio/checks/replacements.hpp"
#include "rio/checks/tilt_check.hpp"
#include "rio/checks/velocity_check.hpp"
#include "rio/core/so3.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/report.hpp"
#include "rio/update/back_end.hpp"

namespace rio {

/// Every check_...() is called at most once per scan, in this order, and returns whether it changed
/// the state estimate: the caller's trails are void then. After a failed propagation or a lost tilt
/// none is called, after a failed update none of those behind it. No allocation after construction.
template <OdometryBackEnd BackEnd>
class Checks {
 public:
  /// @param backend checked and corrected; it and the report must outlive the checks
  Checks(const Options& options, BackEnd* backend, UpdateReport* report)
      : options_(options),
        backend_(*backend),
        report_(*report),
        velocity_(options),
        tilt_(options),
        heading_(kHeadingWindow),
        drift_{CorrectionCheck(kDriftWindow), CorrectionCheck(kDriftWindow),
               CorrectionCheck(kDriftWindow)} {}

  /// The back-end starts over at `time`.
  /// @param unconfirmed from a static alignment: the body may have been in motion
  void reset(Time time, bool unconfirmed) {
    velocity_.reset(time);
    tilt_.reset(time);
    heading_.reset();
    reset_drift();
    position_.reset();
    replaced_.reset();
    last_static_set_ = time;
    unconfirmed_alignment_ = unconfirmed;
  }

  /// The tilt is too uncertain for a linearised update. False if nothing would find it again:
  /// updates then continue.
  bool tilt_is_lost() const {
    constexpr double kLinear = 0.35;  // 1 - cos is 6 % [rad]
    return options_.checks.lost_tilt && sigma_tilt() > kLinear;
  }

  /// The state was propagated from `last`; the buffer holds the samples since.
  /// @param gap the IMU paused since
  void carry(Time last, const ImuBuffer& imu, bool gap) {
    if (options_.checks.velocity) velocity_.carry(backend_.estimate(), last, imu, gap);
    if (options_.checks.tilt) tilt_.carry(backend_.estimate(), last, imu, gap);
  }

  /// Drops the landmarks after a silence of the radar, scans without a static set included, after a
  /// pause of the IMU in which the body may have rotated, and while the tilt is uncertain, as in
  /// strong vibration: with such an uncertain pose landmarks would be mismatched, each well inside
  /// its gate, and turn the heading.
  [[nodiscard]] bool check_landmarks(Time scan, bool imu_gap) {
    constexpr Time kLongest = std::chrono::seconds(1);  // dead reckoning stays within centimetres
    constexpr double kTurn = 0.1;                       // half a metre at a range of 5 m [rad]
    constexpr double kTilt = 0.05;                      // normally a tenth of that [rad]
    if (!options_.checks.landmarks) return false;
    const BodyCovariance P = body_covariance();
    const double turn =
        std::sqrt(P.block<3, 3>(body::kAttitude, body::kAttitude).diagonal().maxCoeff());
    const bool outdated =
        scan - last_static_set_ > kLongest || (imu_gap && turn > kTurn) || sigma_tilt() > kTilt;
    if (outdated) backend_.drop_landmarks(&report_);
    return outdated;
  }
  /// The scan has a static set.
  void saw_static_set(Time scan) { last_static_set_ = scan; }

  /// @param scan corrected for the errors of the radar
  /// @param velocity_covariance of the predicted radar velocity
  /// @param last time of the scan before
  /// @param at_rest the body lies still by the rest detector
  [[nodiscard]] bool check_velocity(const DetectionList& scan, const Matrix3d& velocity_covariance,
                                    Time last, bool at_rest) {
    constexpr double kOpen = 0.5;  // above it the next scans determine the velocity [m/s]
    const Estimate& x = backend_.estimate();
    sigma_velocity_ = std::sqrt(velocity_covariance.trace());
    const auto found = velocity_.observe(scan, x, sigma_velocity_, sigma_tilt(), at_rest);
    report_.velocity_reset = found.has_value();
    report_.velocity_contradicted = velocity_.record().contradicted(x.nav.time);
    if (velocity_.proven()) unconfirmed_alignment_ = false;
    if (!found) {
      if (sigma_velocity_ > kOpen) replaced_ = Replaced{x.nav.time, last};
      return false;
    }
    if (unconfirmed_alignment_) {
      const double speed = found->v_B.norm();
      replace(Invalidates::kNothing, [&](StateEstimate* state_estimate) {
        withdraw_alignment(speed, options_, state_estimate);
      });
    }
    unconfirmed_alignment_ = false;
    act(*found, to_seconds(x.nav.time - velocity_.record().agreed()), doubtful_since());
    return true;
  }

  /// Most of the static set may be movers.
  bool consensus_is_doubtful() const {
    constexpr double kMaxChanceShare = 0.4;  // share of the rows that agree by chance
    return velocity_.chance() > kMaxChanceShare;
  }

  /// @param seen observations of the scan: its static set
  [[nodiscard]] bool check_tilt(const Observations& seen) {
    const Estimate& x = backend_.estimate();
    const auto found =
        tilt_.observe(seen, x, body_covariance(), backend_.state_estimate().velocity_calibration());
    report_.attitude_reset = found.has_value();
    report_.tilt_contradicted = tilt_.record().contradicted(x.nav.time);
    if (!found) return false;
    const Time since = std::min(tilt_.record().agreed(), velocity_.record().agreed());
    replace(Invalidates::kNothing, [&](StateEstimate* state_estimate) {
      replace_tilt(*found, to_seconds(x.nav.time - since), options_, state_estimate);
    });
    act(found->velocity, 0.0, since);  // the velocity diverged gradually
    tilt_.reset(x.nav.time);
    heading_.reset();
    return true;
  }

  /// Call before the update, with the predicted state in the back-end.
  void predicted() {
    const NavState& x = backend_.estimate().nav;
    const BodyCovariance P = body_covariance();
    up_B_ = x.q_WB.conjugate() * Vector3d::UnitZ();
    heading_.predicted(x, up_B_.dot(x.gyro_bias), variance_about_up(P));
    for (int i = 0; i < 3; ++i) {
      drift_[static_cast<std::size_t>(i)].predicted(x, x.v_WB[i],
                                                    P(body::kVelocity + i, body::kVelocity + i));
    }
  }

  [[nodiscard]] bool check_heading() {
    const NavState& x = backend_.estimate().nav;
    const auto found =
        heading_.corrected(x, up_B_.dot(x.gyro_bias), variance_about_up(body_covariance()));
    if (!found || !options_.checks.heading) return false;
    replace(Invalidates::kLandmarks,
            [&](StateEstimate* state_estimate) { widen_heading(*found, state_estimate); });
    report_.attitude_reset = true;
    heading_.reset();
    return true;
  }

  [[nodiscard]] bool check_biases() {
    const NavState& x = backend_.estimate().nav;
    const BodyCovariance P = body_covariance();
    std::optional<LastingError> found;
    for (int i = 0; i < 3; ++i) {
      const int v = body::kVelocity + i;
      const auto along = drift_[static_cast<std::size_t>(i)].corrected(x, x.v_WB[i], P(v, v));
      if (along && !(found && std::abs(found->error) > std::abs(along->error))) found = along;
    }
    if (!found || !options_.checks.biases) return false;
    replace(Invalidates::kLandmarks,
            [&](StateEstimate* state_estimate) { widen_biases(*found, options_, state_estimate); });
    report_.velocity_reset = report_.attitude_reset = true;
    reset_drift();
    heading_.reset();
    return true;
  }

  /// @param health after the scan before
  /// @param seconds since that
  [[nodiscard]] bool check_position(const HealthMonitor& health, double seconds) {
    if (!options_.checks.position) return false;
    const bool outliers = health.health().because(HealthReason::kOutliers);
    const double sigma = position_.observe({.contradiction = velocity_.contradiction(),
                                            .gated = health.unusual_gated_share(),
                                            .sigma = outliers ? sigma_velocity_ : 0.0},
                                           seconds);
    report_.position_reopened = sigma;
    if (sigma == 0.0) return false;
    replace(Invalidates::kLandmarks,
            [&](StateEstimate* state_estimate) { widen_position(sigma, state_estimate); });
    return true;
  }

 private:
  /// A replacement of the velocity, by a check or by scans after it had become uncertain.
  struct Replaced {
    Time at{0};
    Time since{0};  ///< when the replaced velocity may have become wrong
  };

  BodyCovariance body_covariance() const { return backend_.state_estimate().covariance().body(); }

  void reset_drift() {
    for (CorrectionCheck& check : drift_) check.reset();
  }

  /// Of the gyro bias about the vertical [(rad/s)^2].
  double variance_about_up(const BodyCovariance& P) const {
    return up_B_.dot(P.block<3, 3>(body::kGyroBias, body::kGyroBias) * up_B_);
  }

  /// Sigma of roll and pitch together [rad].
  double sigma_tilt() const {
    const BodyCovariance P = body_covariance();
    return std::sqrt(attitude_variance(backend_.estimate().nav.q_WB,
                                       P.block<3, 3>(body::kAttitude, body::kAttitude))
                         .tilt);
  }

  /// The one place where a check changes the state.
  template <class Change>
  void replace(Invalidates also, const Change& change) {
    backend_.replace(change, also, &report_);
  }

  /// Since when the velocity may have been wrong: one that replaced another recently and is now
  /// contradicted may have been wrong from the start, however well the scans supported it.
  Time doubtful_since() const {
    constexpr Time kLong = std::chrono::seconds(30);  // crowds and multipath are shorter
    const Time agreed = velocity_.record().agreed();
    const bool again = replaced_ && backend_.estimate().nav.time - replaced_->at < kLong;
    return again ? std::min(replaced_->since, agreed) : agreed;
  }

  /// Replaces the velocity. The covariance of the position is inflated by the possible effect of
  /// the difference since `since`.
  void act(const IndependentVelocity& found, double duration, Time since) {
    const Time now = backend_.estimate().nav.time;
    replace(Invalidates::kLandmarks, [&](StateEstimate* state_estimate) {
      replace_velocity(found, duration, to_seconds(now - since), state_estimate);
    });
    replaced_ = Replaced{now, since};
    velocity_.reset(now);
    reset_drift();
    position_.reset();
  }

  // a landmark is seen for 20 s, longer than a take-off
  static constexpr CorrectionCheck::Window kHeadingWindow{
      .part = std::chrono::seconds(1),
      .parts = 20,
      .enough = 10,
      .patience = std::chrono::seconds(2),
      .weak = 0.005};  // no bias steps by more [rad/s]
  // in three seconds a bias of 0.1 m/s^2 becomes a velocity that counts
  static constexpr CorrectionCheck::Window kDriftWindow{.part = std::chrono::milliseconds(250),
                                                        .parts = 12,
                                                        .enough = 8,
                                                        .patience = std::chrono::milliseconds(500),
                                                        .weak = 0.1};  // [m/s]

  const Options options_;
  BackEnd& backend_;
  UpdateReport& report_;
  VelocityCheck velocity_;
  TiltCheck tilt_;
  CorrectionCheck heading_;
  std::array<CorrectionCheck, 3> drift_;  ///< of the velocity, axes of W
  Vector3d up_B_ = Vector3d::UnitZ();     ///< before the update
  PositionCheck position_;
  std::optional<Replaced> replaced_;
  Time last_static_set_{0};      ///< stamp of the last scan with a static set
  double sigma_velocity_ = 0.0;  ///< predicted, all axes [m/s]
  bool unconfirmed_alignment_ = false;
};

}  // namespace rio

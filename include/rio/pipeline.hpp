// SPDX-License-Identifier: BSD-3-Clause
// DOOR 2, for researchers: the data flow of one scan, one call per stage, for any back-end. C++20.
//
//   (1) propagate, (3) front-end, (4) models, (5) gate, (6) update, (7) promote, (2) clone
//
// Cloning comes last: a clone is the corrected pose of this scan, kept for the scans after it.
#pragma once

#include "rio/ekf/ekf.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/frontend/velocity_monitor.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/report.hpp"

namespace rio {

template <class BackEnd>
class Pipeline {
 public:
  /// `options` must be valid (Options::validate).
  explicit Pipeline(const Options& options)
      : clock_(options.timing.clock), frontend_(options), monitor_(options), backend_(options) {}

  const Estimate& estimate() const { return backend_.estimate(); }
  const BackEnd& backend() const { return backend_; }
  const UpdateReport& report() const { return report_; }

  void reset(const NavState& prior, const BodyCovariance& P0) {
    frontend_.reset();
    monitor_.reset(prior.time);
    last_scan_ = prior.time;
    backend_.reset(prior, P0);
    report_ = UpdateReport{};
    next_scan_ = 0;
  }

  /// Carries the estimate to `time` without a scan, not beyond the newest IMU sample.
  Status propagate(Time time, const ImuBuffer& imu) {
    bool gap = false;
    return backend_.propagate(time, imu, &gap);
  }

  /// One filtered scan, not older than the estimate and not newer than the IMU. kNumerical: the
  /// estimate is what the IMU alone predicts, or, if that failed, unchanged.
  Status process(const DetectionList& scan, const ImuBuffer& imu) {
    report_ = UpdateReport{};
    report_.time = scan.time;
    const Time start = now();
    report_.status = backend_.propagate(scan.time, imu, &report_.imu_gap);  // (1)
    const Time propagated = now();
    report_.propagation_time = propagated - start;
    if (report_.status != Status::kOk) return report_.status;

    forget_after_silence(scan.time);
    observe(scan);                                      // (3)
    report_.status = backend_.update(seen_, &report_);  // (4) (5) (6)
    if (report_.status == Status::kOk) {
      frontend_.advance(seen_, next_scan_, backend_.landmark_room(seen_), &promotions_);  // (7)
      backend_.maintain_landmarks(seen_, promotions_, &report_);
      backend_.clone(next_scan_);  // (2)
      ++next_scan_;
    }
    summarise(scan);
    report_.update_time = now() - propagated;
    return report_.status;
  }

 private:
  Time now() const { return clock_ != nullptr ? clock_() : Time{0}; }

  /// After a silence of the radar the position is so uncertain that landmarks would be mistaken for
  /// each other, one by one, each well inside its gate: they are dropped.
  void forget_after_silence(Time time) {
    constexpr Time kLongest = std::chrono::seconds(1);  // dead reckoning stays within centimetres
    if (time - last_scan_ > kLongest) {
      backend_.drop_landmarks(&report_);
      frontend_.reset();
    }
    last_scan_ = time;
  }

  /// Stage 3. If the scans have contradicted the velocity for long it is re-opened, and the scan is
  /// seen anew without the trails and landmarks that were placed with it.
  void observe(const DetectionList& scan) {
    const RadarVelocity predicted{Frontend::radar_velocity(backend_.estimate()),
                                  backend_.radar_velocity_covariance()};
    frontend_.observe(scan, backend_.estimate(), &seen_, predicted.covariance);
    report_.velocity_reset = monitor_.contradicts(seen_, predicted);
    if (!report_.velocity_reset) return;
    backend_.reopen_velocity((seen_.ego_velocity.v_S - predicted.v_S).norm(),
                             to_seconds(scan.time - monitor_.agreed()), &report_);
    monitor_.reset(scan.time);
    frontend_.reset();
    frontend_.observe(scan, backend_.estimate(), &seen_, backend_.radar_velocity_covariance());
  }

  void summarise(const DetectionList& scan) {
    report_.detections = scan.received;
    report_.detections_kept = static_cast<int>(scan.items.size());
    report_.static_detections = seen_.ego_velocity.inliers;
    report_.ego_velocity_S = seen_.ego_velocity.v_S;
    report_.ego_velocity_valid = seen_.ego_velocity.valid;
    report_.trails = static_cast<int>(frontend_.trails().size());
    report_.trails_matched = static_cast<int>(seen_.matches.trails.size());
    report_.landmarks_matched = static_cast<int>(seen_.matches.landmarks.size());
    report_.clones = static_cast<int>(backend_.estimate().clones.size());
    report_.landmarks = static_cast<int>(backend_.estimate().landmarks.size());
  }

  Time (*clock_)();
  Frontend frontend_;
  VelocityMonitor monitor_;
  BackEnd backend_;
  Observations seen_;
  Promotions promotions_;
  UpdateReport report_;
  Time last_scan_{0};
  ScanId next_scan_ = 0;
};

}  // namespace rio

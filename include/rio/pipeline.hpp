// SPDX-License-Identifier: BSD-3-Clause
// The research API: the data flow of one scan for any back-end (ekf/ekf.hpp, smoother/smoother.hpp,
// or yours: update/back_end.hpp) and any front-end (frontend/frontend.hpp, or yours:
// frontend/front_end.hpp). C++20. The stages, in the order in which process() runs them:
//
//   1 propagate   propagate/, the back-end      5 update    the back-end
//   2 front-end   frontend/                     6 promote   frontend/, update/landmark_policy.hpp
//   3 models      models/, update/scan_rows     7 clone     the back-end
//   4 gate        update/gate, update/scan_rows (8 predict  the odometry, rio.hpp)
//
// Stochastic cloning comes last: a clone is the corrected pose of this scan, kept for later scans.
// checks/ watches the estimate before and after the update.
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

#include "rio/checks/calibration_report.hpp"
#include "rio/checks/checks.hpp"
#include "rio/checks/health_monitor.hpp"
#include "rio/frontend/front_end.hpp"
#include "rio/frontend/mountings.hpp"
#include "rio/frontend/rest_detector.hpp"
#include "rio/frontend/scan_correction.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/report.hpp"
#include "rio/update/aiding_queue.hpp"
#include "rio/update/back_end.hpp"
#include "rio/update/delayed_start.hpp"
#include "rio/update/ego_velocity_measurement.hpp"
#include "rio/update/landmark_policy.hpp"
#include "rio/update/point_report.hpp"
#include "rio/update/scan_rows.hpp"

namespace rio {

/// Front-end, measurement models, checks and back-end of one estimator; scans are processed in time
/// order.
template <OdometryBackEnd BackEnd, OdometryFrontEnd FrontEnd = Frontend>
class Pipeline {
 public:
  /// `options` must be valid (Options::validate).
  explicit Pipeline(const Options& options)
      : options_(options),
        correction_(options),
        mountings_(options),
        rest_(options),
        rows_(options),
        delayed_(options),
        backend_(options),
        checks_(options, &backend_, &report_),
        health_(options.radars()) {
    for (std::size_t r = 0; r < options.radars(); ++r) {
      frontends_.emplace_back(options.seen_by(r));
    }
    points_.reserve(static_cast<std::size_t>(options.frontend.max_detections));
    seen_.aiding = &aiding_.taken();
    aided_.aiding = &aiding_.taken();
  }
  Pipeline(const Pipeline&) = delete;  // Observations point into it
  Pipeline& operator=(const Pipeline&) = delete;

  const Estimate& estimate() const { return backend_.estimate(); }
  const BackEnd& backend() const { return backend_; }
  /// For functions of a back-end beyond the stages.
  BackEnd& backend() { return backend_; }
  const UpdateReport& report() const { return report_; }
  const Health& health() const { return health_.health(); }
  /// The detections of the last scan, own echoes included; empty if it was not used.
  const std::vector<PointReport>& points() const { return points_; }

  /// Starts over from `prior` with covariance P0, order of namespace body.
  void reset(const NavState& prior, const BodyCovariance& P0) { reset(prior, P0, false); }
  /// Starts from a static alignment. If the Dopplers contradict its velocity before they have
  /// confirmed it, the body was in motion, and so its tilt and its gyro bias are withdrawn.
  void reset(const Alignment& alignment) { reset(alignment.state, alignment.covariance, true); }

  /// The radars may have been mounted anew: unknown mountings that were found are sought again.
  void forget_mountings() { mountings_.forget(); }

  /// Time of measurement of a scan with that stamp, by the current estimate of the time offset.
  Time measured_at(Time stamp, std::size_t radar = 0) const {
    return stamp - from_seconds(estimate().of_radar(radar).time_offset);
  }

  /// The tilt is too uncertain for a linearised update: scans are not used.
  bool tilt_is_lost() const { return checks_.tilt_is_lost(); }

  /// Propagates the estimate to `time` without a scan, not beyond the newest IMU sample.
  Status propagate(Time time, const ImuBuffer& imu) {
    bool gap = false;
    return propagate(time, imu, &gap);
  }

  /// Updates the health between scans, when the IMU has reached `now`.
  /// @param pause of the IMU so far, according to the stamps of the scans that wait for it
  void watch(Time now, Time pause) {
    health_.wait(now, pause, estimate(), backend_.state_estimate().covariance().body());
  }
  /// The IMU has paused for `duration`.
  void add_gap(Time duration) { health_.add_gap(duration); }

  /// The clock of a radar has stepped: its time offset is known to the jitter of arrivals.
  void add_clock_step(std::size_t radar) {
    const auto change = [radar](StateEstimate* state_estimate) {
      widen_time_offset(radar, state_estimate);
    };
    backend_.replace(change, Invalidates::kNothing, &report_);
  }

  /// Queues a measurement of another sensor, in any order: it is used with the first scan not
  /// before its time. False if too many wait.
  bool add(const AidingMeasurement& measurement) { return aiding_.add(measurement); }
  /// The auxiliary state with that first element has not been determined yet.
  bool auxiliary_is_unknown(int first) const { return delayed_.waits(first); }
  /// Time of the oldest measurement in the queue.
  std::optional<Time> next_aiding() const { return aiding_.next(); }

  /// Update without a scan by the queued measurements up to `time`, which must not be after the
  /// newest IMU sample; at `time`, or at the time of the estimate if that is later. kNumerical as
  /// in process().
  Status process_aiding(Time time, const ImuBuffer& imu) {
    report_ = UpdateReport{};
    points_.clear();
    report_.time = time;
    const Time at = std::max(time, estimate().nav.time);
    report_.status = propagate(at, imu, &report_.imu_gap);
    gather(at, imu);
    if (report_.status == Status::kOk && !tilt_is_lost()) {
      rows_.build(aided_, backend_.state_estimate(), &report_);
      report_.status = backend_.update(aided_, rows_);
    }
    summarise_state();
    health_.observe_aiding(report_);
    report_.health = health_.health();
    return report_.status;
  }

  /// Processes one filtered scan, not measured after the newest IMU sample; one measured before the
  /// estimate counts as measured at its time. While tilt_is_lost() the scan is not used.
  /// kNumerical: the estimate is propagated by the IMU only or, if that failed, unchanged.
  Status process(const DetectionList& received, const ImuBuffer& imu) {
    const Time start = now();
    backend_.select_radar(received.radar);
    const Time last = estimate().nav.time;
    const Time measured = processing_time(received, last);
    while (const std::optional<Time> full = aiding_.full_batch(measured)) {
      (void)process_aiding(*full, imu);
    }
    report_ = UpdateReport{};
    points_.clear();
    report_.time = received.time;
    report_.radar = received.radar;
    report_.detections = received.received;
    report_.status = propagate(measured, imu, &report_.imu_gap);  // 1
    const Time propagated = now();
    report_.propagation_time = propagated - start;
    gather(measured, imu);
    if (report_.status != Status::kOk) return conclude();
    if (tilt_is_lost()) return conclude();  // a linearised update could give any tilt

    const bool unusable = mountings_.is_unknown(received.radar) && !find_mounting(received);
    velocity_covariance_ = backend_.state_estimate().radar_velocity_covariance();
    const DetectionList& scan =
        correction_.correct(unusable ? empty_ : received, estimate(), velocity_covariance_);
    if (checks_.check_landmarks(scan.time, report_.imu_gap)) reset_frontends();
    const auto rest = rest_.observe(unusable ? received : scan, last, imu, estimate().nav,
                                    backend_.state_estimate().covariance().body());
    observe(scan, last, rest.has_value());  // 2
    correction_.observe(seen_, estimate());
    seen_.rest = rest;
    if (seen_.rest) mountings_.restart_drifts();
    if (options_.update.use_ego_velocity) {
      const auto velocity = ego_velocity_measurement(*seen_.scan, seen_.ego_velocity, estimate());
      if (velocity) aiding_.take_ego_velocity(*velocity);
    }
    checks_.predicted();
    rows_.build(seen_, backend_.state_estimate(), &report_);  // 3 4
    report_.status = backend_.update(seen_, rows_);           // 5
    correction_.restore_indices(&report_);
    if (report_.status == Status::kOk) {
      report_points(received, correction_.own_echoes(), seen_, estimate(),
                    options_.update.use_trails, &points_);
      const ScanId scan_id = number();
      frontend().advance(seen_, scan_id, landmark_room(estimate(), seen_, options_),
                         &promotions_);  // 6
      backend_.maintain_landmarks(seen_, rows_, promotions_, &report_);
      const double seconds = to_seconds(estimate().nav.time - last);
      if (checks_.check_heading()) reset_frontends();
      if (checks_.check_biases()) reset_frontends();
      if (checks_.check_position(health_, seconds)) reset_frontends();
      backend_.clone(scan_id);  // 7
    }
    summarise(scan);
    report_.update_time = now() - propagated;
    return conclude();
  }

 private:
  void reset(const NavState& prior, const BodyCovariance& P0, bool unconfirmed) {
    points_.clear();
    correction_.reset();
    reset_frontends();
    checks_.reset(prior.time, unconfirmed);
    rest_.reset();
    rows_.reset();
    backend_.reset(prior, P0);
    for (std::size_t r = 0; r < options_.radars(); ++r) {
      if (!mountings_.found(r)) continue;
      const auto change = [&](StateEstimate* state_estimate) {
        state_estimate->set_mounting(r, *mountings_.found(r));
      };
      backend_.replace(change, Invalidates::kLandmarks, &report_);
    }
    mountings_.restart_drifts();
    health_.reset(prior.time);
    report_ = UpdateReport{};
    newest_scan_ = kNoScan;
    aiding_.clear();
    delayed_.reset();
  }

  /// Stage 1, and the evidence gathered by the checks.
  /// @param gap set if the IMU paused since
  Status propagate(Time time, const ImuBuffer& imu, bool* gap) {
    const Time last = estimate().nav.time;
    const Status status = backend_.propagate(time, imu, gap);
    if (status == Status::kOk) checks_.carry(last, imu, *gap);
    return status;
  }

  Time now() const { return options_.timing.clock != nullptr ? options_.timing.clock() : Time{0}; }

  /// Time at which a scan is processed: not before the estimate and, with several radars, at the
  /// time of the estimate if it was measured less than kTogether later.
  Time processing_time(const DetectionList& scan, Time estimate_time) const {
    constexpr Time kTogether = std::chrono::milliseconds(2);
    const Time measured = measured_at(scan.time, scan.radar);
    const bool together = options_.radars() > 1 && measured - estimate_time < kTogether;
    return together ? estimate_time : std::max(measured, estimate_time);
  }

  /// The number of the scan that is processed: that of another radar's scan of this instant, or the
  /// next one.
  ScanId number() {
    const Time time = estimate().nav.time;
    if (newest_scan_ == kNoScan || time != newest_scan_time_) ++newest_scan_;  // kNoScan + 1 is 0
    newest_scan_time_ = time;
    return newest_scan_;
  }

  /// The front-end of the radar whose scan is processed.
  FrontEnd& frontend() { return frontends_[estimate().radar]; }
  void reset_frontends() {
    for (FrontEnd& frontend : frontends_) frontend.reset();
  }

  /// Moves the queued measurements up to `time` to the current update, except those of auxiliary
  /// states that are not known yet; starts the states that are determined now.
  void gather(Time time, const ImuBuffer& imu) {
    aiding_.take(time, estimate().nav, imu, [this](Time t) { return backend_.anchor(t); });
    if (!delayed_.any() || report_.status != Status::kOk) return;
    const StateEstimate& x = backend_.state_estimate();
    report_.aiding_held =
        aiding_.hold_back([&](const AidingObservation& z) { return delayed_.hold(z, x); });
    while (const DelayedStart* found = delayed_.determine(x)) {
      const auto change = [found](StateEstimate* state_estimate) {
        state_estimate->set_auxiliary(found->first, found->value, found->by_body, found->noise);
      };
      backend_.replace(change, Invalidates::kNothing, &report_);
    }
  }

  /// Takes the scan as evidence of the mounting; true if it is known now.
  bool find_mounting(const DetectionList& received) {
    const std::size_t radar = received.radar;
    const BodyCovariance P = backend_.state_estimate().covariance().body();
    report_.mounting_unknown = !mountings_.add(received, estimate(), P, report_.imu_gap);
    if (report_.mounting_unknown) {
      empty_.time = received.time;
      empty_.radar = radar;
      empty_.received = received.received;
      return false;
    }
    const auto change = [&](StateEstimate* state_estimate) {
      state_estimate->set_mounting_and_motion(radar, *mountings_.found(radar));
    };
    backend_.replace(change, Invalidates::kLandmarks, &report_);
    return true;
  }

  /// Stage 2, again after a check has replaced the attitude.
  void observe(const DetectionList& scan, Time last, bool at_rest) {
    if (checks_.check_velocity(scan, velocity_covariance_, last, at_rest)) forget_velocity();
    frontend().observe(scan, estimate(), &seen_, velocity_covariance_);
    if (checks_.check_tilt(seen_)) {
      forget_velocity();
      frontend().observe(scan, estimate(), &seen_, velocity_covariance_);
    } else if (checks_.consensus_is_doubtful()) {
      seen_.withdraw();
    }
    if (seen_.ego_velocity.inliers > 0) checks_.saw_static_set(scan.time);
  }

  /// The velocity has been replaced.
  void forget_velocity() {
    velocity_covariance_ = backend_.state_estimate().radar_velocity_covariance();
    reset_frontends();
    correction_.reset();
  }

  void summarise(const DetectionList& scan) {
    report_.detections_kept = static_cast<int>(scan.items.size());
    report_.static_detections = seen_.ego_velocity.inliers;
    report_.ego_velocity_S = seen_.ego_velocity.v_S;
    report_.ego_velocity_valid = seen_.ego_velocity.valid;
    report_.trails = static_cast<int>(frontend().trails().size());
    report_.trails_matched = static_cast<int>(seen_.matches.trails.size());
    report_.landmarks_matched = static_cast<int>(seen_.matches.landmarks.size());
    report_.at_rest = seen_.rest.has_value();
  }

  void summarise_state() {
    report_.calibration = calibration_report(backend_.state_estimate(), options_);
    report_.clones = static_cast<int>(backend_.estimate().clones.size());
    report_.landmarks = static_cast<int>(backend_.estimate().landmarks.size());
  }

  Status conclude() {
    summarise_state();
    health_.observe(report_, estimate(), backend_.state_estimate().covariance().body());
    report_.health = health_.health();
    return report_.status;
  }

  Options options_;
  ScanCorrection correction_;
  std::vector<FrontEnd> frontends_;  ///< one per radar
  Mountings mountings_;
  DetectionList empty_;  ///< a scan that cannot be used yet
  RestDetector rest_;
  ScanRows rows_;
  DelayedStarts delayed_;
  BackEnd backend_;
  UpdateReport report_;
  std::vector<PointReport> points_;  ///< of the scan of report_
  Checks<BackEnd> checks_;
  Matrix3d velocity_covariance_ = Matrix3d::Zero();  ///< of the predicted radar velocity, axes S
  Observations seen_;
  Observations aided_;  ///< aiding only, without a scan
  AidingQueue aiding_;
  Promotions promotions_;
  HealthMonitor health_;
  ScanId newest_scan_ = kNoScan;  ///< of the last scan processed
  Time newest_scan_time_{0};      ///< of the estimate at it
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The research API: the data flow of one scan, one call per stage, for any back-end
// (ekf/ekf.hpp, smoother/smoother.hpp, or yours). C++20.
//
//   (1) propagate, (3) front-end, (4) models, (5) gate, (6) update, (7) promote, (2) clone
//
// The estimated errors of the radar are removed first: the stamp is corrected by the time offset,
// the detections are corrected for elevation bias and Doppler scale. Stochastic cloning comes last:
// a clone is the corrected pose of this scan, kept for later scans.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#include "rio/frontend/frontend.hpp"
#include "rio/frontend/gravity_check.hpp"
#include "rio/frontend/own_echoes.hpp"
#include "rio/frontend/rest_detector.hpp"
#include "rio/frontend/velocity_pool.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/report.hpp"
#include "rio/update/aiding_queue.hpp"
#include "rio/update/calibration_report.hpp"
#include "rio/update/doubtful_interval.hpp"
#include "rio/update/gyro_bias_check.hpp"
#include "rio/update/health_monitor.hpp"

namespace rio {

/// Front-end, consistency checks and back-end of one estimator; scans are processed in time order.
template <class BackEnd>
class Pipeline {
 public:
  /// `options` must be valid (Options::validate).
  explicit Pipeline(const Options& options)
      : options_(options),
        pool_(options),
        gravity_(options),
        gyro_bias_(options),
        rest_(options),
        backend_(options),
        corrected_(options.frontend.max_detections) {
    for (std::size_t r = 0; r < options.radars(); ++r) {
      frontends_.emplace_back(options.seen_by(r));
      own_echoes_.emplace_back(options.radar_of(r).max_doppler);
    }
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

  /// Starts over from `prior` with covariance P0, order of namespace body.
  void reset(const NavState& prior, const BodyCovariance& P0) {
    reset_own_echoes();
    reset_frontends();
    pool_.reset(prior.time);
    gravity_.reset(prior.time);
    gyro_bias_.reset();
    doubtful_.reset();
    rest_.reset();
    last_static_set_ = prior.time;
    replaced_.reset();
    backend_.reset(prior, P0);
    birge_ratios_ = {};
    health_.reset(prior.time);
    report_ = UpdateReport{};
    next_scan_ = 0;
    aiding_.clear();
    unconfirmed_alignment_ = false;
  }
  /// Starts from a static alignment. If the Dopplers contradict its velocity before they have
  /// confirmed it, the body was in motion, and so its tilt and its gyro bias are withdrawn.
  void reset(const Alignment& alignment) {
    reset(alignment.state, alignment.covariance);
    unconfirmed_alignment_ = true;
  }

  /// Time of measurement of a scan with that stamp, by the current estimate of the time offset.
  Time measured_at(Time stamp, std::size_t radar = 0) const {
    return stamp - from_seconds(estimate().of_radar(radar).time_offset);
  }

  /// The tilt is too uncertain for a linearised update. False without velocity_recovery: updates
  /// then continue.
  bool tilt_is_lost() const {
    constexpr double kLinear = 0.35;  // 1 - cos is 6 % [rad]
    return options_.frontend.velocity_recovery && sigma_tilt() > kLinear;
  }

  /// Propagates the estimate to `time` without a scan, not beyond the newest IMU sample.
  Status propagate(Time time, const ImuBuffer& imu) {
    bool gap = false;
    return backend_.propagate(time, imu, &gap);
  }

  /// Updates the health between scans, when the IMU has reached `now`.
  /// @param pause of the IMU so far, according to the stamps of the scans that wait for it
  void watch(Time now, Time pause) {
    health_.wait(now, pause, estimate(), backend_.state_estimate().covariance().body());
  }
  /// The IMU has paused for `duration`.
  void add_gap(Time duration) { health_.add_gap(duration); }

  /// Queues a measurement of another sensor, in any order: it is used with the first scan not
  /// before its time. False if too many wait.
  bool add(const AidingMeasurement& measurement) { return aiding_.add(measurement); }
  /// Time of the oldest measurement in the queue.
  std::optional<Time> next_aiding() const { return aiding_.next(); }

  /// Update without a scan by the queued measurements up to `time`, which must not be after the
  /// newest IMU sample; at `time`, or at the time of the estimate if that is later. kNumerical as
  /// in process().
  Status process_aiding(Time time, const ImuBuffer& imu) {
    report_ = UpdateReport{};
    report_.time = time;
    const Time at = std::max(time, estimate().nav.time);
    report_.status = backend_.propagate(at, imu, &report_.imu_gap);
    gather(at, imu);
    if (report_.status == Status::kOk && !tilt_is_lost()) {
      report_.status = backend_.update(aided_, &report_);
    }
    summarise_state();
    report_.health = health_.health();
    return report_.status;
  }

  /// Processes one filtered scan, not measured after the newest IMU sample; one measured before the
  /// estimate counts as measured at its time. While tilt_is_lost() the scan is not used.
  /// kNumerical: the estimate is propagated by the IMU only or, if that failed, unchanged.
  Status process(const DetectionList& received, const ImuBuffer& imu) {
    report_ = UpdateReport{};
    report_.time = received.time;
    report_.radar = received.radar;
    backend_.select_radar(received.radar);
    const Time start = now();
    const Time last = estimate().nav.time;
    const Time measured = taken_at(received, last);
    while (const std::optional<Time> full = aiding_.full_batch(measured)) {
      (void)process_aiding(*full, imu);
    }
    report_.status = backend_.propagate(measured, imu, &report_.imu_gap);  // (1)
    const Time propagated = now();
    report_.propagation_time = propagated - start;
    gather(measured, imu);
    if (report_.status != Status::kOk) return conclude();

    if (tilt_is_lost()) return conclude();  // a linearised update could give any tilt

    velocity_covariance_ = backend_.state_estimate().radar_velocity_covariance();
    const DetectionList& scan = without_own_echoes(corrected(received));
    forget_after_silence(scan.time);
    observe(scan, last, imu);  // (3)
    if (seen_.ego_velocity.inliers > 0) last_static_set_ = scan.time;
    seen_.rest = rest_.observe(scan, last, imu, estimate().nav,
                               backend_.state_estimate().covariance().body());
    gyro_bias_.predicted(estimate(), backend_.state_estimate().covariance().body());
    report_.status = backend_.update(seen_, &report_);  // (4) (5) (6)
    count_own_echoes();
    if (report_.status == Status::kOk) {
      frontend().advance(seen_, next_scan_, backend_.landmark_room(seen_), &promotions_);  // (7)
      backend_.maintain_landmarks(seen_, promotions_, &report_);
      check_gyro_bias();
      check_position(to_seconds(estimate().nav.time - last));
      backend_.clone(next_scan_);  // (2)
      ++next_scan_;
    }
    summarise(scan);
    report_.update_time = now() - propagated;
    return conclude();
  }

 private:
  Time now() const { return options_.timing.clock != nullptr ? options_.timing.clock() : Time{0}; }

  /// Time at which a scan is processed: not before the estimate and, with several radars, at the
  /// time of the estimate if it was measured less than kTogether later.
  Time taken_at(const DetectionList& scan, Time estimate_time) const {
    constexpr Time kTogether = std::chrono::milliseconds(2);
    const Time measured = measured_at(scan.time, scan.radar);
    const bool together = options_.radars() > 1 && measured - estimate_time < kTogether;
    return together ? estimate_time : std::max(measured, estimate_time);
  }

  /// The front-end of the radar whose scan is processed.
  Frontend& frontend() { return frontends_[estimate().radar]; }
  void reset_own_echoes() {
    for (OwnEchoes& own : own_echoes_) own.reset();
  }
  void reset_frontends() {
    for (Frontend& frontend : frontends_) frontend.reset();
  }

  /// Moves the queued measurements up to `time` to the current update.
  void gather(Time time, const ImuBuffer& imu) {
    aiding_.take(time, estimate().nav, imu, [this](Time t) { return backend_.anchor(t); });
  }

  /// The scan corrected for the estimated errors of the radar.
  const DetectionList& corrected(const DetectionList& scan) {
    const RadarErrors::Value& errors = estimate().radar_errors;
    if (errors.isZero(0.0)) return scan;
    corrected_ = scan;
    for (Detection& d : corrected_.items) d = correct_detection(d, errors);
    return corrected_;
  }

  /// The scan without echoes of the vehicle.
  const DetectionList& without_own_echoes(const DetectionList& scan) {
    own_.clear();
    if (!options_.frontend.own_echoes) return scan;
    own_echoes_[scan.radar].observe(scan, radar_velocity(estimate()), velocity_covariance_, &own_);
    if (own_.empty()) return scan;
    if (&scan != &corrected_) corrected_ = scan;
    for (std::size_t i = own_.size(); i-- > 0;) {
      corrected_.items.erase(corrected_.items.begin() + static_cast<std::ptrdiff_t>(own_[i]));
    }
    return corrected_;
  }

  /// Makes the records refer to the detections of the filtered scan, own echoes included.
  void count_own_echoes() {
    for (InnovationRecord& record : report_.records) {
      if (record.model == Model::kAiding) continue;
      std::size_t detection = record.detection;
      for (const std::size_t own : own_) detection += own <= detection ? 1 : 0;
      record.detection = static_cast<std::uint16_t>(detection);
    }
  }

  /// Drops landmarks and trails after a silence of the radar, scans without a static set included,
  /// or a pause of the IMU in which the body may have rotated: with such an uncertain pose
  /// landmarks would be mismatched, each well inside its gate.
  void forget_after_silence(Time time) {
    constexpr Time kLongest = std::chrono::seconds(1);  // dead reckoning stays within centimetres
    constexpr double kTurn = 0.1;                       // half a metre at a range of 5 m [rad]
    const BodyCovariance P = backend_.state_estimate().covariance().body();
    const double turn =
        std::sqrt(P.block<3, 3>(body::kAttitude, body::kAttitude).diagonal().maxCoeff());
    if (time - last_static_set_ > kLongest || (report_.imu_gap && turn > kTurn)) {
      backend_.drop_landmarks(&report_);
      reset_frontends();
    }
  }

  /// Stage 3. Velocity or tilt are replaced if the scans have contradicted them for long enough.
  void observe(const DetectionList& scan, Time last, const ImuBuffer& imu) {
    const Estimate& x = backend_.estimate();
    constexpr double kOpen = 0.5;  // above it the next scans determine the velocity [m/s]
    const double sigma = std::sqrt(velocity_covariance_.trace());
    const auto other = pool_.observe(scan, x, sigma, sigma_tilt(), last, imu, report_.imu_gap);
    report_.velocity_reset = other.has_value();
    report_.velocity_contradicted = to_seconds(x.nav.time - pool_.contradicted_since());
    if (pool_.proven()) unconfirmed_alignment_ = false;
    if (other) {
      if (unconfirmed_alignment_) backend_.withdraw_alignment(other->v_B.norm());
      unconfirmed_alignment_ = false;
      restart_velocity(*other, to_seconds(x.nav.time - pool_.agreed()), doubtful_since());
    } else if (sigma > kOpen) {
      replaced_ = Replaced{x.nav.time, last};
    }
    frontend().observe(scan, x, &seen_, velocity_covariance_);
    const auto down = gravity_.observe(seen_, x, backend_.state_estimate().covariance().body(),
                                       backend_.state_estimate().velocity_calibration(), last, imu,
                                       report_.imu_gap);
    report_.attitude_reset = down.has_value();
    report_.tilt_contradicted =
        to_seconds(x.nav.time - gravity_.contradicted_since().value_or(x.nav.time));
    if (!down) {
      constexpr double kMost = 0.4;  // above it the consensus may be one of movers
      if (pool_.chance() > kMost) seen_.withdraw();
      return;
    }
    const Time since = std::min(gravity_.agreed(), pool_.agreed());
    backend_.restart_attitude(down->g_B, down->sigma, down->velocity.v_B,
                              to_seconds(x.nav.time - since));
    restart_velocity(down->velocity, 0.0, since);  // the velocity diverged gradually
    gravity_.reset(x.nav.time);
    gyro_bias_.reset();
    frontend().observe(scan, x, &seen_, velocity_covariance_);
  }

  /// If the scans contradict the gyro bias about the vertical, inflates its covariance and that of
  /// the heading; drops landmarks and trails, which have rotated with it.
  void check_gyro_bias() {
    const auto opinion =
        gyro_bias_.corrected(estimate(), backend_.state_estimate().covariance().body());
    if (!opinion) return;
    backend_.restart_heading(*opinion, &report_);
    report_.attitude_reset = true;
    gyro_bias_.reset();
    reset_frontends();
  }

  /// If an interval has ended in which the scans contradicted the estimate, inflates the covariance
  /// of the position by the possible effect; drops landmarks and trails.
  void check_position(double seconds) {
    if (!options_.frontend.velocity_recovery) return;
    const double sigma =
        doubtful_.observe(pool_.contradiction(), health_.unusual_gated_share(), seconds);
    report_.position_reopened = sigma;
    if (sigma == 0.0) return;
    backend_.reopen_position(sigma, &report_);
    reset_frontends();
  }

  /// Since when the velocity may have been wrong: one that replaced another recently and is now
  /// contradicted may have been wrong from the start, however well the scans supported it.
  Time doubtful_since() const {
    constexpr Time kLong = std::chrono::seconds(30);  // crowds and multipath are shorter
    const bool again = replaced_ && estimate().nav.time - replaced_->at < kLong;
    return again ? std::min(replaced_->since, pool_.agreed()) : pool_.agreed();
  }

  /// Replaces the velocity and drops landmarks and trails. The covariance of the position is
  /// inflated by the possible effect of the difference since `since`.
  void restart_velocity(const VelocityOpinion& other, double duration, Time since) {
    const Time now = estimate().nav.time;
    backend_.restart_velocity(other.v_B, other.covariance, duration, to_seconds(now - since),
                              &report_);
    velocity_covariance_ = backend_.state_estimate().radar_velocity_covariance();
    replaced_ = Replaced{now, since};
    pool_.reset(now);
    doubtful_.reset();
    reset_frontends();
    reset_own_echoes();
  }

  /// Sigma of roll and pitch together [rad].
  double sigma_tilt() const {
    const BodyCovariance P_body = backend_.state_estimate().covariance().body();
    const Matrix3d P = P_body.block<3, 3>(body::kAttitude, body::kAttitude);
    const Vector3d up_B = estimate().nav.q_WB.conjugate() * Vector3d::UnitZ();
    return std::sqrt(std::max(0.0, P.trace() - up_B.dot(P * up_B)));
  }

  void summarise(const DetectionList& scan) {
    report_.detections = scan.received;
    report_.detections_kept = static_cast<int>(scan.items.size());
    report_.static_detections = seen_.ego_velocity.inliers;
    report_.ego_velocity_S = seen_.ego_velocity.v_S;
    report_.ego_velocity_valid = seen_.ego_velocity.valid;
    report_.trails = static_cast<int>(frontend().trails().size());
    report_.trails_matched = static_cast<int>(seen_.matches.trails.size());
    report_.landmarks_matched = static_cast<int>(seen_.matches.landmarks.size());
    report_.at_rest = seen_.rest.has_value();
    summarise_state();
  }

  void summarise_state() {
    report_.calibration =
        calibration_report(backend_.state_estimate(), options_, &birge_ratios_[estimate().radar]);
    report_.clones = static_cast<int>(backend_.estimate().clones.size());
    report_.landmarks = static_cast<int>(backend_.estimate().landmarks.size());
  }

  Status conclude() {
    health_.observe(report_, estimate(), backend_.state_estimate().covariance().body());
    report_.health = health_.health();
    return report_.status;
  }

  /// A replacement of the velocity, by a check or by scans after it had become uncertain.
  struct Replaced {
    Time at{0};
    Time since{0};  ///< when the replaced velocity may have become wrong
  };

  Options options_;
  std::vector<Frontend> frontends_;    ///< one per radar
  std::vector<OwnEchoes> own_echoes_;  ///< same
  VelocityPool pool_;
  GravityCheck gravity_;
  GyroBiasCheck gyro_bias_;
  DoubtfulInterval doubtful_;
  RestDetector rest_;
  BackEnd backend_;
  std::array<BirgeRatios, kMaxRadars> birge_ratios_{};
  Matrix3d velocity_covariance_ = Matrix3d::Zero();  ///< of the predicted radar velocity, axes S
  StaticVector<std::size_t, kMaxDetections> own_;    ///< own echoes in the current scan
  DetectionList corrected_;
  Observations seen_;
  Observations aided_;  ///< aiding only, without a scan
  AidingQueue aiding_;
  Promotions promotions_;
  UpdateReport report_;
  HealthMonitor health_;
  Time last_static_set_{0};  ///< stamp of the last scan with a static set
  std::optional<Replaced> replaced_;
  bool unconfirmed_alignment_ = false;
  ScanId next_scan_ = 0;
};

}  // namespace rio

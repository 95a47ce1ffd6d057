// SPDX-License-Identifier: BSD-3-Clause
// The implementation of the odometry API: the pipeline, queues and time handling, for any back-end.
// Each back-end is compiled in its own file.
#pragma once

#include <optional>
#include <vector>

#include "odometry_impl.hpp"
#include "prior_check.hpp"
#include "rio/checks/imu_guard.hpp"
#include "rio/checks/stamp_guard.hpp"
#include "rio/pipeline.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/moving_start.hpp"
#include "rio/propagate/predictor.hpp"
#include "rio/propagate/restart.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/propagate/strapdown.hpp"
#include "scan_intake.hpp"

namespace rio {

template <class Estimator>
class Engine final : public Odometry::Impl {
 public:
  explicit Engine(const Options& o)
      : options_(o),
        pipeline_(o),
        imu_(o.timing, o.imu),
        stamps_(from_seconds(o.timing.max_pause)),
        guard_(o.imu),
        predictor_(o.imu.gravity),
        aligner_(o.start, o.imu),
        moving_start_(o.start, o.imu.gravity),
        restart_(o.start, o.imu),
        scans_(options_) {
    for (std::size_t r = 0; r < o.radars(); ++r) (void)extrinsics.push_back(o.mount(r).T_BS);
    landmarks_.reserve(kMaxLandmarks);
  }

  const NavState& at_scan() const override { return pipeline_.estimate().nav; }
  const NavState& now() const override { return predictor_.state(); }
  const UpdateReport& report() const override { return pipeline_.report(); }
  const Health& health() const override { return pipeline_.health(); }
  const std::vector<PointReport>& points() const override { return pipeline_.points(); }

  const std::vector<LandmarkReport>& landmarks() override {
    const StateEstimate& x = pipeline_.backend().state_estimate();
    landmarks_.clear();
    for (std::size_t i = 0; i < x.estimate().landmarks.size(); ++i) {
      const LandmarkState& landmark = x.estimate().landmarks[i];
      const int at = x.layout().landmark(static_cast<int>(i));
      landmarks_.push_back(
          {landmark.p_W, x.covariance().matrix().block<3, 3>(at, at), landmark.last_seen});
    }
    return landmarks_;
  }

  const BodyCovariance& covariance_now() override {
    if (!initialized || imu_.empty()) return covariance;
    imu_.for_each_step(ahead_.state.time, imu_.newest().time,
                       [this](const ImuStep& step) { ahead_.step(step, options_.imu); });
    covariance_now_ = congruence(ahead_.transition(), covariance) + ahead_.noise();
    return covariance_now_;
  }

  Status add_imu(const ImuSample& sample) override {
    const StampVerdict stamp = stamps_.check(sample.time);
    if (!sample.gyro_B.allFinite() || !sample.accel_B.allFinite()) {
      return refuse(counters.imu_non_finite, Status::kNonFinite);
    }
    if (stamp == StampVerdict::kOld) return refuse(counters.imu_stale, Status::kStale);
    if (stamp == StampVerdict::kAhead) return refuse(counters.imu_ahead, Status::kAhead);
    if (const ImuFault fault = guard_.check(sample); fault != ImuFault::kNone) {
      ++(fault == ImuFault::kFrozen ? counters.imu_frozen : counters.imu_out_of_range);
      return Status::kImplausible;
    }
    ++counters.imu_samples;
    if (stamp == StampVerdict::kRestarted &&
        !scans_.goes_through(imu_.newest().time, sample.time)) {
      restart_clock();
    }
    if (initialized && imu_.empty() && !is_near(sample.time)) carry_to(sample.time);
    stamps_.take(sample.time);
    scans_.hear_imu();
    if (!imu_.empty() && imu_.is_gap(imu_.newest(), sample)) {
      ++counters.imu_gaps;
      const Time gap = sample.time - imu_.newest().time;
      pipeline_.add_gap(gap);
      if (gap > StampGuard::kSudden) scans_.imu_jumped(gap);
      if (initialized) restart_.pause(at_scan(), covariance, sample.time);
    }
    if (initialized && imu_.full()) catch_up(imu_[1 + imu_.size() / kSteps].time);
    imu_.push_back(sample);
    if (!initialized) return options_.start.static_alignment ? align(sample) : Status::kOk;
    predictor_.advance(imu_);
    process_ready();
    follow(sample.time);
    if (!watched_ || sample.time >= *watched_ + kWatch) watch(Time{0});
    recover_tilt(sample);
    return Status::kOk;
  }

  Status add_scan(const RadarScan& scan, std::size_t radar) override {
    if (radar >= options_.radars()) return Status::kUndeclared;
    const Time stamp = scans_.corrected(scan.time, radar, imu_);
    if (scans_.clock_stepped(radar)) carry_radar_clock(radar);
    if (!initialized) return refuse(counters.scans_uninitialized, Status::kNotInitialized);
    const Time measured = is_stamp(stamp) ? pipeline_.measured_at(stamp, radar) : stamp;
    const Status taken =
        scans_.accept(scan, {radar, stamp, measured}, at_scan().time, imu_, &counters);
    if (taken == Status::kOk) {
      const Status status = count(scans_.accepted(), pipeline_.process(scans_.accepted(), imu_));
      process_ready();
      return status;
    }
    if (const Time pause = scans_.pause(imu_); pause > from_seconds(options_.imu.max_gap)) {
      watch(pause);
    }
    if (taken != Status::kWaiting) return taken;
    process_ready();  // scans of other radars may have waited for this one
    return scans_.queue().contains(stamp, radar) ? Status::kWaiting : pipeline_.report().status;
  }

  Status add_measurement(const AidingMeasurement& z) override {
    if (!initialized) return Status::kNotInitialized;
    if (z.radar() >= options_.radars() || !z.is_declared(options_.auxiliary)) {
      return Status::kUndeclared;
    }
    if (!z.is_valid()) return Status::kNumerical;
    const Time delay = from_seconds(options_.timing.aiding_delay);
    if (z.time() < at_scan().time - delay || (!imu_.empty() && z.time() < imu_[0].time)) {
      return refuse(counters.aiding_late, Status::kLate);
    }
    if (scans_.is_ahead(z.time(), at_scan().time, imu_)) {
      return refuse(counters.aiding_ahead, Status::kAhead);
    }
    if (!pipeline_.add(z)) return refuse(counters.aiding_overflow, Status::kQueueFull);
    ++counters.aiding;
    return Status::kWaiting;
  }

  bool auxiliary(const char* name, int index, int asked, double* value, double* P) const override {
    int size = 0;
    const int first = options_.auxiliary.find(name, index, &size);
    if (asked != 0 && asked != size) return false;
    if (!initialized || first < 0 || pipeline_.auxiliary_is_unknown(first)) return false;
    const StateEstimate& state_estimate = pipeline_.backend().state_estimate();
    const int at = state_estimate.layout().auxiliary() + first;
    Eigen::Map<Eigen::VectorXd>(value, size) =
        state_estimate.estimate().auxiliary.segment(first, size);
    Eigen::Map<Eigen::MatrixXd>(P, size, size) =
        state_estimate.covariance().matrix().block(at, at, size, size);
    return true;
  }

  Status reset(const NavState& prior, const BodyCovariance& P0) override {
    if (!is_finite(prior) || !P0.allFinite()) return Status::kNonFinite;
    if (!is_plausible(prior, P0)) return Status::kImplausible;
    if (!is_near_unit(prior.q_WB) || !is_covariance(P0)) return Status::kNumerical;
    if (is_before_buffer(prior.time)) return Status::kLate;
    if (is_beyond_buffer(prior.time)) return Status::kAhead;
    NavState start = prior;
    start.q_WB.normalize();
    pipeline_.reset(start, P0);
    restart_.reset();
    counters = Counters{};
    forget_scans();
    scans_.forget_fingerprints();
    initialized = true;
    publish();
    return Status::kOk;
  }

  void reset() override {
    initialized = false;
    imu_.clear();
    stamps_.reset();
    scans_.reset_clocks();
    guard_.reset();
    aligner_.reset();
    moving_start_.reset();
    restart_.reset();
    forget_scans();
    counters = Counters{};
    pipeline_.forget_mountings();
    pipeline_.reset(NavState{}, BodyCovariance::Zero());
    publish();
  }

 private:
  void forget_scans() {
    scans_.forget(imu_);
    watched_.reset();
  }

  void process_ready() {
    while (!scans_.queue().empty()) {
      const DetectionList& next = scans_.queue().front();
      const Time measured = pipeline_.measured_at(next.time, next.radar);
      if (!scans_.is_ready(measured, next.radar, imu_)) return;
      (void)count(next, pipeline_.process(next, imu_));
      scans_.pop();
    }
  }

  /// More than max_lag before the buffered samples: the IMU data from `time` on are incomplete.
  bool is_before_buffer(Time time) const {
    if (!is_stamp(time)) return time < Time{0};
    return !imu_.empty() && imu_[0].time - time > from_seconds(options_.timing.max_lag);
  }
  bool is_beyond_buffer(Time time) const {
    if (!is_stamp(time)) return time > Time{0};
    return !imu_.empty() && time - imu_.newest().time > from_seconds(options_.timing.max_ahead);
  }

  /// The newest sample of the buffer is the first one after a gap.
  bool ends_gap(const ImuSample& newest) const {
    return imu_.size() > 1 && imu_.is_gap(imu_[imu_.size() - 2], newest);
  }

  /// The first sample may belong to the time of the start.
  bool is_near(Time time) const { return std::chrono::abs(time - at_scan().time) <= kNear; }

  /// The clock of the IMU has jumped.
  void restart_clock() {
    ++counters.clock_restarts;
    ImuSample last = imu_.newest();
    if (initialized) catch_up(last.time);
    const Time jump = stamps_.newest_in_run() - last.time;
    last.time += jump;
    imu_.clear();
    aligner_.reset();
    moving_start_.reset();
    scans_.imu_jumped(jump);
    if (!initialized) return;
    imu_.push_back(last);  // a gap follows, to the first sample of the new clock
    add_unknown_pause(options_.imu, at_scan().v_WB.norm(), covariance);
    carry_to(last.time);
  }

  /// The clock of a radar has stepped. Its scans that wait have stamps of neither clock.
  void carry_radar_clock(std::size_t radar) {
    ++counters.radar_clock_steps;
    counters.scans_late += scans_.queue().size();
    forget_scans();
    pipeline_.add_clock_step(radar);
    publish();
  }

  /// Restarts the pipeline with the estimate assumed valid at `time`.
  void carry_to(Time time) {
    NavState state = at_scan();
    state.time = time;
    hold(state, BodyCovariance(covariance));
  }

  /// Restarts the pipeline from `state`; the queued scans are discarded as late.
  void hold(const NavState& state, const BodyCovariance& P) {
    counters.scans_late += scans_.queue().size();
    forget_scans();
    restart_.reset();
    pipeline_.reset(state, P);
    publish();
  }

  Status align(const ImuSample& sample) {
    std::optional<Alignment> alignment;
    Status status = aligner_.add(sample, &alignment);
    if (ends_gap(sample)) moving_start_.reset();
    const std::optional<Alignment> moving = moving_start_.add(sample);
    if (!alignment && !moving) return status;
    if (alignment) {
      pipeline_.reset(*alignment);
    } else {
      pipeline_.reset(moving->state, moving->covariance);
      ++counters.moving_starts;
    }
    forget_scans();
    initialized = true;
    publish();
    return Status::kOk;
  }

  /// After the pipeline has processed a scan.
  Status count(const DetectionList& scan, Status status) {
    scans_.processed(scan, at_scan().time);
    ++(status == Status::kOk ? counters.scans : counters.updates_failed);
    counters.velocity_resets += pipeline_.report().velocity_reset ? 1 : 0;
    counters.attitude_resets += pipeline_.report().attitude_reset ? 1 : 0;
    counters.position_reopened += pipeline_.report().position_reopened > 0.0 ? 1 : 0;
    publish();
    call_on_scan();
    return status;
  }

  /// Which may replace itself.
  void call_on_scan() {
    if (!on_scan) return;
    std::function<void()> call;
    call.swap(on_scan);
    on_scan_set = false;
    call();
    if (!on_scan_set) on_scan.swap(call);
  }

  /// Re-initialises the tilt from the specific force where it is lost (propagate/restart.hpp).
  void recover_tilt(const ImuSample& sample) {
    if (!options_.checks.lost_tilt) return;
    if (!restart_.active()) {
      const bool diverged = pipeline_.health().has_diverged();
      if (!diverged && !pipeline_.tilt_is_lost()) return restart_.passed(at_scan().time);
      restart_.begin(at_scan(), covariance, diverged, sample.time);
    }
    const std::optional<Alignment> found = restart_.add(sample, ends_gap(sample));
    if (!found) return;
    ++counters.restarts;
    hold(found->state, found->covariance);
  }

  void watch(Time pause) {
    watched_ = imu_.newest().time;
    pipeline_.watch(*watched_, pause);
  }

  /// Keeps the estimate within max_lag of the newest sample while no scan arrives. In steps,
  /// because each costs the prediction from there to the newest sample.
  void follow(Time newest) {
    const Time lag = from_seconds(options_.timing.max_lag);
    const std::optional<Time> aiding = pipeline_.next_aiding();
    const Time oldest = aiding ? std::min(*aiding, at_scan().time) : at_scan().time;
    if (newest - oldest < lag) return;
    catch_up(newest - lag + lag / kSteps);
  }

  void catch_up(Time time) {
    while (const std::optional<Time> next = pipeline_.next_aiding()) {
      if (*next > time) break;
      if (pipeline_.process_aiding(*next, imu_) != Status::kOk) ++counters.updates_failed;
      publish();
    }
    if (at_scan().time >= time) return;
    if (pipeline_.propagate(time, imu_) != Status::kOk) ++counters.updates_failed;
    publish();
  }

  /// Updates what the accessors return and drops the samples before the estimate.
  void publish() {
    covariance = pipeline_.backend().state_estimate().covariance().body();
    for (std::size_t r = 0; r < options_.radars(); ++r) {
      extrinsics[r] = pipeline_.estimate().of_radar(r).T_BS;
    }
    imu_.forget_before(at_scan().time - from_seconds(options_.timing.aiding_delay));
    predictor_.rebase(at_scan(), imu_);
    ahead_ = Propagation{};
    ahead_.state = at_scan();
  }

  static constexpr std::size_t kSteps = 20;                      // of max_lag, or of a full buffer
  static constexpr Time kNear = std::chrono::seconds(10);        // of a start to the first sample
  static constexpr Time kWatch = std::chrono::milliseconds(50);  // delay of reporting a silence

  Options options_;
  Pipeline<Estimator> pipeline_;
  ImuBuffer imu_;
  StampGuard stamps_;
  ImuGuard guard_;
  Predictor predictor_;
  Propagation ahead_;  ///< from the last scan to the newest sample at the last covariance_now()
  BodyCovariance covariance_now_ = BodyCovariance::Zero();
  std::vector<LandmarkReport> landmarks_;  ///< of the last landmarks()
  StaticAligner aligner_;
  MovingStart moving_start_;
  Restart restart_;
  ScanIntake scans_;
  std::optional<Time> watched_;  ///< last update of the health between scans
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "replay_run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "live/host_clock.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "replay_feed.hpp"
#include "replay_summary.hpp"
#include "rio/aiding.hpp"
#include "rio/io/dataset.hpp"
#include "rio/models/aids.hpp"
#include "rio/rio.hpp"
#include "stop_signal.hpp"

namespace rio::tools {

namespace {

/// All of the ground truth; empty if there is none.
eval::Trajectory truth_for_view(const ReplayArguments& arguments, const OpenRecording& recording) {
  const bool folder = io::is_dataset_folder(arguments.dataset);
  if (folder && recording.sensors.ground_truth.empty()) return {};
  try {
    return path_of(arguments.dataset, arguments.how.truth);
  } catch (const std::runtime_error&) {
    if (folder) throw;
    return {};  // a bag without a topic of it
  }
}

view::RunStart run_start(const ReplayArguments& arguments, const OpenRecording& recording,
                         const Options& options, const std::string& source) {
  const std::string name = named(arguments.dataset).filename().string();
  return {name,
          options,
          truth_for_view(arguments, recording),
          source != "groundtruth",
          RIO_VERSION,
          recording.samples->outline().imu_begin};
}

/// Feeds samples and scans in the order of their stamps, in a pause of the IMU, too, as live.
class Replay {
 public:
  /// @param steps of the clocks, to be taken out
  Replay(const ReplayArguments& arguments, const OpenRecording& recording, const Options& options,
         check::ClockSteps steps, ViewOutputs* view, const OnScan& on_scan)
      : arguments_(arguments),
        outline_(recording.samples->outline()),
        on_scan_(on_scan),
        view_(view),
        start_(make_start(
            arguments.init, recording.sensors.ground_truth, outline_.imu_begin, outline_.imu_end,
            [&](ImuSample* sample) { return recording.samples->next(sample); }, options)),
        feed_(recording.samples.get(), std::move(steps)) {
    Options used = options;
    used.start.static_alignment = !start_;
    std::string why;
    odometry_ = Odometry::create(used, &why);
    if (odometry_ == nullptr) throw std::runtime_error(why);
    odometry_->on_scan([this] { record(); });
    summary_.health.add(outline_.imu_begin, odometry_->health());
    const std::string source = start_ ? start_->source : "";
    if (view->any()) view->begin(run_start(arguments, recording, used, source));
    if (start_) begin(*start_);
    outputs_.emplace(arguments, outline_.imu_begin);
    if (arguments.barometer) heights_.emplace(recording.samples.get());
  }

  ReplaySummary run() {
    const bool shows_lines = outputs_->prints_lines() && isatty(STDOUT_FILENO) != 0;
    Progress progress(!shows_lines && !arguments_.silent);
    while (const ImuSample* sample = feed_.imu()) {
      if (stop_requested != 0) return finish(sample->time);
      pace(sample->time);
      progress.show(imu_, outline_.imu_samples);
      if (const std::optional<Time> due = feed_.due(); due && *due < sample->time) {
        give_scan();
      } else {
        give_imu(*sample);
        if (heights_) give_heights(sample->time);
        next_imu();
      }
    }
    while (waiting_ == 0 && feed_.due()) give_scan();
    return finish(std::nullopt);
  }

 private:
  void begin(const Start& start) {
    restart(start.state, start.covariance);
    const Time time = start.state.time;
    while (feed_.imu(1) != nullptr && feed_.imu(1)->time <= time) next_imu();
    std::size_t radar = 0;
    for (auto due = feed_.due(); due && *due < time; due = feed_.due()) {
      (void)feed_.take_scan(&radar);
      ++summary_.scans_before_start;
    }
  }

  /// Of the recording, for those who watch it.
  void pace(Time time) {
    if (arguments_.view.port.empty()) return;
    if (!paced_from_) {
      paced_from_ = live::HostClock::real() - time;
      catch_stop_signals();
    }
    std::this_thread::sleep_for(*paced_from_ + time - live::HostClock::real());
  }

  void next_imu() {
    feed_.pass_imu();
    ++imu_;
  }

  /// With the velocity of the arguments, if they give one.
  void restart(NavState state, const BodyCovariance& covariance) {
    const std::vector<double>& velocity = arguments_.init_velocity;
    if (!velocity.empty()) state.v_WB = Vector3d(velocity.data());
    const Status status = odometry_->reset(state, covariance);
    if (status == Status::kOk) return;
    throw std::runtime_error(
        status == Status::kImplausible
            ? "the start was refused: a position beyond 1e7 m, another value beyond 1e4, or a "
              "sigma beyond 1e6 (SI units)"
            : "the start was refused: a value is not finite, or the covariance not positive");
  }

  void give_imu(const ImuSample& sample) {
    const bool was_initialized = odometry_->initialized();
    const std::uint64_t restarts = this->restarts();
    timed([&] { (void)odometry_->add_imu(sample); });  // its outcome is counted
    if (odometry_->initialized()) summary_.health.add(sample.time, odometry_->health());
    view_->watch(*odometry_);
    if (!was_initialized && odometry_->initialized() && !arguments_.init_velocity.empty()) {
      restart(odometry_->at_scan(), BodyCovariance(odometry_->covariance()));
    }
    if (this->restarts() != restarts) waiting_ = 0;  // they have been discarded as late
  }

  std::uint64_t restarts() const {
    return odometry_->counters().clock_restarts + odometry_->counters().restarts;
  }

  /// Barometer heights up to that time; dropped before the start.
  void give_heights(Time time) {
    while (const auto height = heights_->take(time)) {
      const HeightModel::Measurement z{height->height, heights_->sigma()};
      (void)odometry_->add_measurement({height->time, HeightModel{}, z});  // its outcome is counted
    }
  }

  void give_scan() {
    std::size_t radar = 0;
    const RadarScan& scan = feed_.take_scan(&radar);
    Status status = Status::kOk;
    timed([&] { status = odometry_->add_scan(scan, radar); });
    if (status == Status::kNotInitialized) ++summary_.scans_before_start;
    if (!several_ && status == Status::kWaiting) ++waiting_;
  }

  /// Calls the estimator, whose time is counted without that of recording.
  template <class Call>
  void timed(const Call& call) {
    const Time before = live::HostClock::real();
    recording_ = Time{0};
    call();
    summary_.wall += live::HostClock::real() - before - recording_;
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

  /// Within a call of the estimator, which does not throw.
  void record() noexcept {
    const Time before = live::HostClock::real();
    if (waiting_ > 0) --waiting_;
    try {
      if (!error_) record_scan();
    } catch (...) {
      error_ = std::current_exception();
    }
    recording_ += live::HostClock::real() - before;
  }

  /// A failed update has no row: its estimate is not at the scan.
  void record_scan() {
    if (odometry_->report().status != Status::kOk) return;
    const NavState& state = odometry_->at_scan();
    if (!(state.p_WB + state.v_WB + state.gyro_bias + state.accel_bias).allFinite() ||
        !state.q_WB.coeffs().allFinite() || !odometry_->covariance().allFinite()) {
      throw std::runtime_error(
          fmt::format("the estimate is not finite at {} s", io::seconds_text(state.time)));
    }
    outputs_->add(*odometry_);
    if (on_scan_) on_scan_(*odometry_);
    view_->add(*odometry_);
    summary_.add(odometry_->report(), state);
  }

  /// @param stopped there by a signal
  ReplaySummary finish(std::optional<Time> stopped) {
    outputs_->close();
    const std::size_t left = feed_.scans_left();
    summary_.started = odometry_->initialized();
    summary_.scans_unprocessed = waiting_ + (stopped ? 0 : static_cast<int>(left));
    summary_.counters = odometry_->counters();
    summary_.initialised_by = start_ ? start_->source : start_name(summary_.counters);
    summary_.height_offset = auxiliary<HeightOffset>(*odometry_);
    summary_.span = stopped.value_or(outline_.imu_end) - outline_.imu_begin;
    if (stopped) {
      print_notes(
          {fmt::format("stopped after {:.1f} s of the recording", to_seconds(summary_.span))});
    }
    double recorded = stopped ? -static_cast<double>(left) : 0.0;
    for (const std::vector<Time>& stamps : outline_.scan_times) {
      recorded += static_cast<double>(stamps.size());
    }
    summary_.health.conclude(summary_.calibration, summary_.is_absurd(), summary_.scans / recorded);
    return std::move(summary_);
  }

  const ReplayArguments& arguments_;
  const io::RecordingOutline& outline_;
  const OnScan& on_scan_;
  ViewOutputs* view_;
  std::optional<Start> start_;  ///< reads the samples, so before the feed
  ReplayFeed feed_;
  std::size_t imu_ = 0;  ///< samples that have passed
  std::optional<HeightFeed> heights_;
  bool several_ = outline_.scan_times.size() > 1;  ///< radars
  std::optional<ScanOutputs> outputs_;             ///< after the start, which may fail
  std::optional<Time> paced_from_;  ///< this machine's clock minus that of the recording
  std::unique_ptr<Odometry> odometry_;
  int waiting_ = 0;           ///< scans of the single radar that wait for the IMU
  Time recording_{0};         ///< spent on it within a call
  std::exception_ptr error_;  ///< of recording
  ReplaySummary summary_;
};

}  // namespace

ReplaySummary fly(const ReplayArguments& arguments, const OpenRecording& recording,
                  const Options& options, check::ClockSteps steps, ViewOutputs* view,
                  const OnScan& on_scan) {
  return Replay(arguments, recording, options, std::move(steps), view, on_scan).run();
}

}  // namespace rio::tools

// SPDX-License-Identifier: BSD-3-Clause
// `rio replay`: a recording through the estimator, as a flight stack would feed it.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands.hpp"
#include "findings.hpp"
#include "progress.hpp"
#include "recording.hpp"
#include "replay_summary.hpp"
#include "rio/aiding.hpp"
#include "rio/io/barometer.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/start.hpp"
#include "rio/io/trajectory.hpp"
#include "rio/models/aids.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/rio.hpp"

namespace rio::tools {

namespace {

/// First state and covariance, and where they come from.
struct Start {
  NavState state;
  BodyCovariance covariance;
  std::string source;
};

Time steady_now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

Options make_options(const ReplayArguments& arguments, const io::Dataset& dataset) {
  Options base;
  if (arguments.barometer) (void)base.auxiliary.declare<HeightOffset>();
  Options options = make_options(arguments.estimator, dataset, base);
  options.timing.clock = &steady_now;
  return options;
}

/// The first pose and velocity of the ground truth inside the span of the IMU. Biases start at
/// zero, except that a standstill right there measures the gyro bias.
Start start_from_truth(const io::Dataset& dataset, const Options& options) {
  const auto row = std::find_if(
      dataset.ground_truth.begin(), dataset.ground_truth.end(), [&](const NavState& state) {
        return state.time >= dataset.imu.front().time && state.time <= dataset.imu.back().time;
      });
  if (row == dataset.ground_truth.end()) {
    throw std::runtime_error(
        "--init groundtruth: the dataset has no ground truth " +
        std::string(dataset.ground_truth.empty() ? "at all" : "within the time span of its IMU"));
  }
  Start start{*row, io::start_covariance(row->q_WB, options.start), "groundtruth"};
  start.state.gyro_bias.setZero();
  start.state.accel_bias.setZero();
  const auto bias = standstill_gyro_bias(dataset.imu, row->time, options);
  if (bias) {
    constexpr double kGyroBiasFloor = 1e-4;  // instability over minutes [rad/s]
    const double sigma =
        kGyroBiasFloor + options.imu.gyro_noise_density / std::sqrt(options.start.duration);
    start.state.gyro_bias = *bias;
    start.covariance.block<3, 3>(body::kGyroBias, body::kGyroBias) =
        Matrix3d::Identity() * sigma * sigma;
  }
  return start;
}

/// Nothing for a static start.
std::optional<Start> make_start(const ReplayArguments& arguments, const io::Dataset& dataset,
                                const Options& options) {
  std::string init = arguments.init;
  if (init.empty()) init = dataset.ground_truth.empty() ? "static" : "groundtruth";
  if (init == "static") return std::nullopt;
  if (init == "groundtruth") return start_from_truth(dataset, options);
  const io::StartFile file = io::load_start(init, options.start, dataset.imu.front().time);
  return Start{file.state, file.covariance, "file"};
}

/// Where the estimate of each processed scan goes.
class Outputs {
 public:
  void open(const ReplayArguments& arguments, Time begin) {
    begin_ = begin;
    lines_ = arguments.verbose && !arguments.json && !arguments.quiet;
    if (!arguments.out.empty()) trajectory_.emplace(arguments.out);
    if (!arguments.states.empty()) states_.emplace(arguments.states);
  }

  void add(const Odometry& odometry) {
    const NavState& state = odometry.at_scan();
    if (trajectory_) {
      trajectory_->write(io::tum_line({state.time, state.p_WB, state.q_WB}) + "\n");
    }
    if (states_) states_->add(state, odometry.covariance());
    if (lines_) print_line(state, odometry.report());
  }

  void close() {
    if (trajectory_) trajectory_->close();
    if (states_) states_->close();
  }

 private:
  void print_line(const NavState& state, const UpdateReport& report) const {
    int used = 0;
    int gated = 0;
    for (const ModelReport& model : report.models) {
      used += model.rows_used;
      gated += model.rows_gated;
    }
    fmt::print(
        "{:9.3f} s  position {:8.3f} {:8.3f} {:8.3f} m  speed {:6.3f} m/s  points {:3} static {:3}"
        "  rows {:3} gated {:3}\n",
        to_seconds(state.time - begin_), state.p_WB.x(), state.p_WB.y(), state.p_WB.z(),
        state.v_WB.norm(), report.detections_kept, report.static_detections, used, gated);
  }

  Time begin_{0};
  bool lines_ = false;
  std::optional<io::TextFile> trajectory_;
  std::optional<io::StatesFile> states_;
};

/// When to give each scan: by its stamp, or, if that is out of order, by the next one that is not.
/// In order is the longest rising sequence: one odd stamp holds up no other scan.
std::vector<Time> due_times(const std::vector<RadarScan>& scans) {
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> ends;  // last scan of the best sequence of each length
  std::vector<std::size_t> before(scans.size(), kNone);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const auto at =
        std::upper_bound(ends.begin(), ends.end(), scans[i].time,
                         [&scans](Time time, std::size_t end) { return time < scans[end].time; });
    if (at != ends.begin()) before[i] = *(at - 1);
    if (at == ends.end()) {
      ends.push_back(i);
    } else {
      *at = i;
    }
  }
  std::vector<Time> due(scans.size());
  std::size_t in_order = ends.empty() ? kNone : ends.back();
  Time next = in_order == kNone ? Time{0} : scans[in_order].time;
  for (std::size_t i = scans.size(); i-- > 0;) {
    if (i == in_order) {
      next = scans[i].time;
      in_order = before[i];
    }
    due[i] = next;
  }
  return due;
}

/// A scan, whose it is, and when to give it.
struct Given {
  const RadarScan* scan = nullptr;
  std::size_t radar = 0;
  Time due{0};
};
/// Of all radars, in the order in which they are given.
std::vector<Given> schedule(const io::Dataset& dataset) {
  std::vector<Given> out;
  const auto add = [&out](const std::vector<RadarScan>& scans, std::size_t radar) {
    const std::vector<Time> due = due_times(scans);
    for (std::size_t i = 0; i < scans.size(); ++i) out.push_back({&scans[i], radar, due[i]});
  };
  add(dataset.scans, 0);
  for (std::size_t r = 0; r < dataset.other_radars.size(); ++r) {
    add(dataset.other_radars[r].scans, r + 1);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Given& a, const Given& b) { return a.due < b.due; });
  return out;
}

/// Feeds the samples in the order of their stamps. One scan at most waits for the IMU, so that no
/// report is overwritten by the next before it was read; scans inside a gap of the IMU are
/// therefore given after it, and those farther back than timing.max_lag count as late. Those of
/// several radars wait for each other.
class Replay {
 public:
  Replay(const ReplayArguments& arguments, const io::Dataset& dataset, const Options& options)
      : dataset_(dataset), scans_(schedule(dataset)), several_(!dataset.other_radars.empty()) {
    const std::optional<Start> start = make_start(arguments, dataset, options);
    Options used = options;
    used.start.static_alignment = !start;
    std::string why;
    odometry_ = Odometry::create(used, &why);
    if (odometry_ == nullptr) throw std::runtime_error(why);
    if (!arguments.init_velocity.empty()) {
      const std::vector<double>& v = arguments.init_velocity;
      init_velocity_ = Vector3d(v[0], v[1], v[2]);
    }
    summary_.initialised_by = start ? start->source : "static";
    if (start) begin(*start);
    outputs_.open(arguments, dataset.imu.front().time);
    if (!arguments.barometer) return;
    heights_ = io::barometric_heights(dataset.baro);
    if (heights_.samples.empty()) throw std::runtime_error("--barometer: there is no baro0");
  }

  ReplaySummary run() {
    Progress progress(isatty(STDOUT_FILENO) == 0);
    while (imu_ < dataset_.imu.size()) {
      progress.show(imu_, dataset_.imu.size());
      const bool scan_first =
          scan_ < scans_.size() && !waiting_ && scans_[scan_].due < dataset_.imu[imu_].time;
      if (scan_first) {
        give_scan(scans_[scan_++]);
      } else {
        give_imu(dataset_.imu[imu_++]);
        give_heights(dataset_.imu[imu_ - 1].time);
      }
    }
    while (!waiting_ && scan_ < scans_.size()) give_scan(scans_[scan_++]);
    return finish();
  }

 private:
  void begin(const Start& start) {
    NavState state = start.state;
    if (init_velocity_) state.v_WB = *init_velocity_;
    restart(state, start.covariance);
    while (imu_ + 1 < dataset_.imu.size() && dataset_.imu[imu_ + 1].time <= state.time) ++imu_;
    while (scan_ < scans_.size() && scans_[scan_].due < state.time) ++scan_;
    summary_.scans_before_start = static_cast<int>(scan_);
  }

  void restart(const NavState& state, const BodyCovariance& covariance) {
    const Status status = odometry_->reset(state, covariance);
    if (status == Status::kOk) return;
    throw std::runtime_error(std::string("the start was refused: ") + to_string(status));
  }

  void give_imu(const ImuSample& sample) {
    const bool was_initialized = odometry_->initialized();
    const std::uint64_t restarts = odometry_->counters().clock_restarts;
    const Time before = steady_now();
    (void)odometry_->add_imu(sample);  // what it did is counted
    const Time after = steady_now();
    summary_.wall += after - before;
    if (odometry_->initialized()) summary_.health.add(sample.time, odometry_->health());
    if (!was_initialized && odometry_->initialized() && init_velocity_) {
      NavState state = odometry_->at_scan();
      state.v_WB = *init_velocity_;
      restart(state, BodyCovariance(odometry_->covariance()));
    }
    if (waiting_ && odometry_->report().time == *waiting_) {
      waiting_.reset();
      record();
    }
    if (several_) record_new();
    // a scan of the clock before is not waited for
    if (odometry_->counters().clock_restarts != restarts) waiting_.reset();
  }

  /// The barometer's, up to that time; before the start they are left out.
  void give_heights(Time time) {
    for (; height_ < heights_.samples.size() && heights_.samples[height_].time <= time; ++height_) {
      const auto& sample = heights_.samples[height_];
      const HeightModel::Measurement z{sample.height, heights_.sigma};
      (void)odometry_->add_measurement({sample.time, HeightModel{}, z});  // what it did is counted
    }
  }

  void give_scan(const Given& given) {
    const Time before = steady_now();
    const Status status = odometry_->add_scan(*given.scan, given.radar);
    summary_.wall += steady_now() - before;
    if (status == Status::kNotInitialized) ++summary_.scans_before_start;
    if (several_) {
      record_new();
      return;
    }
    if (status == Status::kWaiting) waiting_ = given.scan->time;
    if (status == Status::kOk) record();
  }

  /// Of several radars any call may process scans; of two in one call the last is seen.
  void record_new() {
    if (odometry_->counters().scans == recorded_) return;
    recorded_ = odometry_->counters().scans;
    record();
  }

  /// A failed update has no row: its estimate is not at the scan.
  void record() {
    if (odometry_->report().status != Status::kOk) return;
    const NavState& state = odometry_->at_scan();
    if (!(state.p_WB + state.v_WB + state.gyro_bias + state.accel_bias).allFinite() ||
        !state.q_WB.coeffs().allFinite() || !odometry_->covariance().allFinite()) {
      throw std::runtime_error("the estimate is not finite at " + io::seconds_text(state.time) +
                               " s");
    }
    outputs_.add(*odometry_);
    summary_.add(odometry_->report(), state);
  }

  ReplaySummary finish() {
    outputs_.close();
    if (!odometry_->initialized()) {
      throw std::runtime_error(
          "static alignment failed: the sensor moves, or the recording is shorter than "
          "start.duration; give a start with --init");
    }
    summary_.scans_unprocessed = static_cast<int>(scans_.size() - scan_) + (waiting_ ? 1 : 0);
    summary_.counters = odometry_->counters();
    if (several_) summary_.scans = static_cast<int>(summary_.counters.scans);
    summary_.height_offset = auxiliary<HeightOffset>(*odometry_);
    summary_.span = dataset_.imu.back().time - dataset_.imu.front().time;
    summary_.health.conclude(summary_.calibration, summary_.is_absurd());
    return summary_;
  }

  const io::Dataset& dataset_;
  io::BarometricHeights heights_;  ///< to give
  std::size_t height_ = 0;         ///< next of them
  std::vector<Given> scans_;
  bool several_ = false;        ///< radars
  std::uint64_t recorded_ = 0;  ///< scans of several radars
  Outputs outputs_;
  std::unique_ptr<Odometry> odometry_;
  std::optional<Vector3d> init_velocity_;
  std::optional<Time> waiting_;  ///< stamp of the scan that waits for the IMU
  std::size_t imu_ = 0;          ///< next sample
  std::size_t scan_ = 0;         ///< next scan
  ReplaySummary summary_;
};

}  // namespace

void replay(const ReplayArguments& arguments) {
  std::string damage;
  const io::Dataset dataset =
      read_any(arguments.dataset, arguments.how, &damage, io::Truth::kStart);
  const Options options = make_options(arguments, dataset);
  ReplaySummary summary = Replay(arguments, dataset, options).run();
  if (!arguments.no_check) {
    Options checked;  // what is overridden has been noted
    (void)tell_sensors_and_file(dataset, arguments.estimator.config, &checked);
    summary.data = not_ok(findings_of(arguments.dataset, dataset, checked));
  }
  if (summary.data && worst(*summary.data) == check::Verdict::kWrong) {
    fmt::print(stderr, "note: something is wrong with the recording; see `rio check`\n");
  }
  if (arguments.json) {
    fmt::print("{}\n", summary.json());
  } else {
    fmt::print("{}", summary.text());
  }
  if (summary.health.lost()) {
    throw LostEstimate(fmt::format(
        "the estimate is lost: {}; fastest {:.3g} m/s, farthest {:.3g} m; check units, axes, "
        "mounting and the start",
        summary.health.lost_because(), summary.fastest, summary.farthest));
  }
  throw_damage(damage);
}

}  // namespace rio::tools

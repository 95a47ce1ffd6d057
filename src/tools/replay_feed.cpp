// SPDX-License-Identifier: BSD-3-Clause
#include "replay_feed.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "check/order.hpp"
#include "rio/propagate/static_alignment.hpp"

namespace rio::tools {

namespace {

/// The first pose and velocity of the ground truth inside the span of the IMU. Biases start at
/// zero, except that a standstill at that time measures the gyro bias.
Start start_from_truth(const std::vector<NavState>& truth, Time begin, Time end,
                       const NextSample& next, const Options& options) {
  const auto row = std::find_if(truth.begin(), truth.end(), [&](const NavState& state) {
    return state.time >= begin && state.time <= end;
  });
  if (row == truth.end()) {
    throw std::runtime_error(
        "--init groundtruth: no ground truth is read" +
        std::string(truth.empty()
                        ? ": there is none, or several topics of which --truth chooses one"
                        : " within the time span of the IMU"));
  }
  Start start{{*row, io::start_covariance(row->q_WB, options.start)}, "groundtruth"};
  start.state.gyro_bias.setZero();
  start.state.accel_bias.setZero();
  const auto bias = standstill_gyro_bias(next, row->time, options);
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

/// When to give each scan: at its stamp, or, if that is out of order, at the next one in order. In
/// order is the longest increasing sequence, so that one outlier holds up no other scan.
std::vector<Time> due_times(std::vector<Time> stamps) {
  if (std::is_sorted(stamps.begin(), stamps.end())) return stamps;
  std::vector<std::size_t> order = check::longest_sequence(
      stamps.size(), [&](std::size_t i) { return stamps[i]; }, std::less_equal<>{});
  Time due = order.empty() ? Time::max() : stamps[order.back()];
  for (std::size_t i = stamps.size(); i-- > 0;) {
    if (!order.empty() && i == order.back()) {
      due = stamps[i];
      order.pop_back();
    }
    stamps[i] = due;
  }
  return stamps;
}

}  // namespace

std::optional<Start> make_start(const std::string& init, const std::vector<NavState>& truth,
                                Time begin, Time end, const NextSample& next,
                                const Options& options) {
  if (init == "static" || (init.empty() && truth.empty())) return std::nullopt;
  if (init.empty() || init == "groundtruth") {
    return start_from_truth(truth, begin, end, next, options);
  }
  return Start{io::load_start(init, options.start, begin), "file"};
}

ReplayFeed::ReplayFeed(io::RecordingStream* stream, check::ClockSteps steps)
    : stream_(stream), imu_steps_(std::move(steps.imu)) {
  steps.radars.resize(stream->outline().scan_times.size());
  for (std::vector<Time> stamps : stream->outline().scan_times) {
    std::vector<check::ClockStep>& of = steps.radars[radars_.size()];
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      stamps[i] = check::without_steps(stamps[i], of, i);
    }
    radars_.push_back({due_times(std::move(stamps)), std::move(of)});
  }
  stream->rewind();
}

const ImuSample* ReplayFeed::imu(std::size_t ahead) {
  while (imu_.size() <= ahead) {
    ImuSample sample;
    if (!stream_->next(&sample)) return nullptr;
    sample.time = check::without_steps(sample.time, imu_steps_, samples_read_++);
    imu_.push_back(sample);
  }
  return &imu_[ahead];
}

std::size_t ReplayFeed::first_due() const {
  std::size_t first = radars_.size();
  for (std::size_t r = 0; r < radars_.size(); ++r) {
    if (radars_[r].left() == 0) continue;
    if (first == radars_.size() || radars_[r].next_due() < radars_[first].next_due()) first = r;
  }
  return first;
}

std::optional<Time> ReplayFeed::due() const {
  const std::size_t r = first_due();
  if (r == radars_.size()) return std::nullopt;
  return radars_[r].next_due();
}

const RadarScan& ReplayFeed::take_scan(std::size_t* radar) {
  *radar = first_due();
  Radar& of = radars_[*radar];
  if (!stream_->next(&scan_, *radar)) {  // the file has been cut meanwhile
    scan_ = {};
    of.due.resize(of.next + 1);
  }
  scan_.time = check::without_steps(scan_.time, of.steps, of.next);
  ++of.next;
  return scan_;
}

std::size_t ReplayFeed::scans_left() const {
  std::size_t left = 0;
  for (const Radar& radar : radars_) left += radar.left();
  return left;
}

HeightFeed::HeightFeed(io::RecordingStream* stream) {
  std::vector<io::BaroSample> samples;
  for (io::BaroSample sample; stream->next(&sample);) samples.push_back(sample);
  heights_ = io::barometric_heights(samples);
  if (heights_.samples.empty()) {
    throw std::runtime_error(
        "--barometer: there is no baro0, and no topic of a barometer is read (--pressure chooses)");
  }
}

std::optional<HeightFeed::Height> HeightFeed::take(Time until) {
  if (next_ == heights_.samples.size() || heights_.samples[next_].time > until) return std::nullopt;
  return heights_.samples[next_++];
}

}  // namespace rio::tools

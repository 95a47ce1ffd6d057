// SPDX-License-Identifier: BSD-3-Clause
#include "replay_start.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "rio/io/start.hpp"
#include "rio/propagate/static_alignment.hpp"

namespace rio::tools {

namespace {

/// As standstill_gyro_bias() of static_alignment.hpp, without reading farther than necessary.
std::optional<Vector3d> gyro_bias_at_rest(io::RecordingStream* samples, Time from,
                                          const Options& options) {
  StaticAligner aligner(options.start, options.imu);
  std::optional<Alignment> result;
  samples->rewind();
  for (ImuSample sample; samples->next(&sample);) {
    if (sample.time < from || !(sample.gyro_B + sample.accel_B).allFinite()) continue;
    if (aligner.add(sample, &result) == Status::kMoving) return std::nullopt;
    if (result) return result->state.gyro_bias;
  }
  return std::nullopt;
}

/// The first pose and velocity of the ground truth inside the span of the IMU. Biases start at
/// zero, except that a standstill at that time measures the gyro bias.
Start start_from_truth(const OpenRecording& recording, const Options& options) {
  const io::RecordingOutline& outline = recording.samples->outline();
  const std::vector<NavState>& truth = recording.sensors.ground_truth;
  const auto row = std::find_if(truth.begin(), truth.end(), [&](const NavState& state) {
    return state.time >= outline.imu_begin && state.time <= outline.imu_end;
  });
  if (row == truth.end()) {
    throw std::runtime_error(
        "--init groundtruth: the dataset has no ground truth " +
        std::string(truth.empty() ? "at all" : "within the time span of its IMU"));
  }
  Start start{*row, io::start_covariance(row->q_WB, options.start), "groundtruth"};
  start.state.gyro_bias.setZero();
  start.state.accel_bias.setZero();
  const auto bias = gyro_bias_at_rest(recording.samples.get(), row->time, options);
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

}  // namespace

std::optional<Start> make_start(const ReplayArguments& arguments, const OpenRecording& recording,
                                const Options& options) {
  std::string init = arguments.init;
  if (init.empty()) init = recording.sensors.ground_truth.empty() ? "static" : "groundtruth";
  if (init == "static") return std::nullopt;
  if (init == "groundtruth") return start_from_truth(recording, options);
  const Alignment file =
      io::load_start(init, options.start, recording.samples->outline().imu_begin);
  return Start{file.state, file.covariance, "file"};
}

}  // namespace rio::tools

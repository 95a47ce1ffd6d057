// SPDX-License-Identifier: BSD-3-Clause
// From what a recording says of its sensors to options.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "rio/io/dataset.hpp"

namespace rio::io {

namespace {

void copy(const std::optional<double>& from, double* to) {
  if (from) *to = *from;
}
void copy_sigma(const std::optional<double>& from, double* to) {
  if (from && *from > 0.0) *to = *from;
}

/// A prior of what is not estimated is of no use.
void copy_prior(const std::optional<double>& from, double* to) {
  if (from && *to > 0.0) *to = *from;
}

/// Widened by three sigmas on both sides; a sigma grows as 1/cos towards the edge.
double widened_fov(double fov, double sigma) {
  constexpr double kMinCosine = 0.25;  // as in models/detection.hpp
  return std::min(std::numbers::pi, fov + 6.0 * sigma / std::max(std::cos(0.5 * fov), kMinCosine));
}

}  // namespace

void apply_sensor_info(const Dataset& dataset, Options* options) {
  const ImuInfo& imu = dataset.imu_info;
  copy(imu.gyro_noise_density, &options->imu.gyro_noise_density);
  copy(imu.gyro_random_walk, &options->imu.gyro_random_walk);
  copy(imu.accel_noise_density, &options->imu.accel_noise_density);
  copy(imu.accel_random_walk, &options->imu.accel_random_walk);

  const RadarInfo& info = dataset.radar_info;
  RadarOptions& radar = options->radar;
  if (info.T_BS) radar.T_BS = *info.T_BS;
  copy_sigma(info.sigma_range, &radar.sigma_range);
  copy_sigma(info.sigma_azimuth, &radar.sigma_azimuth);
  copy_sigma(info.sigma_elevation, &radar.sigma_elevation);
  copy_sigma(info.sigma_doppler, &radar.sigma_doppler);
  copy(info.weak_snr_db, &radar.weak_snr_db);
  copy(info.range_resolution, &radar.range_resolution);
  copy(info.doppler_resolution, &radar.doppler_resolution);
  copy(info.max_doppler, &radar.max_doppler);
  copy(info.time_offset, &radar.time_offset);
  copy(info.doppler_scale, &radar.doppler_scale);
  options->other_radars.clear();
  for (const Dataset::OtherRadar& other : dataset.other_radars) {
    RadarMount mount = options->mount(0);
    if (other.info.T_BS) mount.T_BS = *other.info.T_BS;
    copy(other.info.time_offset, &mount.time_offset);
    copy(other.info.doppler_scale, &mount.doppler_scale);
    (void)options->other_radars.push_back(mount);
  }
  CalibrationOptions& calibration = options->calibration;
  copy_prior(info.prior_rotation, &calibration.rotation_sigma);
  copy_prior(info.prior_position, &calibration.translation_sigma);
  copy_prior(info.prior_time_offset, &calibration.time_offset_sigma);
  copy_prior(info.prior_doppler_scale, &calibration.doppler_scale_sigma);
  if (info.max_range) radar.max_range = *info.max_range + 3.0 * radar.sigma_range;
  if (info.fov_azimuth) radar.fov_azimuth = widened_fov(*info.fov_azimuth, radar.sigma_azimuth);
  if (info.fov_elevation) {
    radar.fov_elevation = widened_fov(*info.fov_elevation, radar.sigma_elevation);
  }
}

}  // namespace rio::io

// SPDX-License-Identifier: BSD-3-Clause
// From the sensor properties of a recording to options.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "rio/io/dataset.hpp"

namespace rio::io {

namespace {

/// The properties in sensor files, option by option.
struct Teller {
  std::vector<std::string>* keys;  ///< receives those of the options, if not null
  bool all = false;                ///< of all options, else of those that were set

  template <class Value, class Option>
  void copy(const char* key, const std::optional<Value>& from, Option* to) {
    if (keys != nullptr && (all || from)) keys->emplace_back(key);
    if (from) *to = *from;
  }
  /// Zero is not a noise model.
  void copy_sigma(const char* key, const std::optional<double>& from, double* to) {
    copy(key, from && *from > 0.0 ? from : std::nullopt, to);
  }
  /// A prior is used only if the parameter is estimated.
  void copy_prior(const char* key, const std::optional<double>& from, double* to) {
    copy(key, *to > 0.0 ? from : std::nullopt, to);
  }
};

template <class Function>
std::optional<double> changed(const std::optional<double>& value, const Function& function) {
  if (!value) return std::nullopt;
  return function(*value);
}

/// Widened by three sigmas on both sides; a sigma grows as 1/cos towards the edge.
double widened_fov(double fov, double sigma) {
  constexpr double kMinCosine = 0.25;  // as in models/detection.hpp
  return std::min(std::numbers::pi, fov + 6.0 * sigma / std::max(std::cos(0.5 * fov), kMinCosine));
}

void tell_radar(const RadarInfo& info, RadarOptions* out, Teller teller) {
  RadarOptions& radar = *out;
  std::optional<Vector3d> translation;
  std::optional<Quaternion> rotation;
  if (info.T_BS) translation = info.T_BS->translation;
  if (info.T_BS) rotation = info.T_BS->rotation;
  teller.copy("radar.T_BS.translation", translation, &radar.T_BS.translation);
  teller.copy("radar.T_BS.quaternion_wxyz", rotation, &radar.T_BS.rotation);
  teller.copy_sigma("radar.sigma_range", info.sigma_range, &radar.sigma_range);
  teller.copy_sigma("radar.sigma_azimuth", info.sigma_azimuth, &radar.sigma_azimuth);
  teller.copy_sigma("radar.sigma_elevation", info.sigma_elevation, &radar.sigma_elevation);
  teller.copy_sigma("radar.sigma_doppler", info.sigma_doppler, &radar.sigma_doppler);
  teller.copy("radar.weak_snr_db", info.weak_snr_db, &radar.weak_snr_db);
  teller.copy("radar.range_resolution", info.range_resolution, &radar.range_resolution);
  teller.copy("radar.doppler_resolution", info.doppler_resolution, &radar.doppler_resolution);
  teller.copy("radar.max_doppler", info.max_doppler, &radar.max_doppler);
  teller.copy("radar.time_offset", info.time_offset, &radar.time_offset);
  teller.copy("radar.doppler_scale", info.doppler_scale, &radar.doppler_scale);
  const auto range = [&](double limit) { return limit + 3.0 * radar.sigma_range; };
  const auto azimuth = [&](double fov) { return widened_fov(fov, radar.sigma_azimuth); };
  const auto elevation = [&](double fov) { return widened_fov(fov, radar.sigma_elevation); };
  teller.copy("radar.max_range", changed(info.max_range, range), &radar.max_range);
  teller.copy("radar.fov_azimuth", changed(info.fov_azimuth, azimuth), &radar.fov_azimuth);
  teller.copy("radar.fov_elevation", changed(info.fov_elevation, elevation), &radar.fov_elevation);
}

void tell(const Dataset& dataset, Options* options, Teller teller) {
  const ImuInfo& info_imu = dataset.imu_info;
  ImuOptions& imu = options->imu;
  teller.copy("imu.gyro_noise_density", info_imu.gyro_noise_density, &imu.gyro_noise_density);
  teller.copy("imu.gyro_random_walk", info_imu.gyro_random_walk, &imu.gyro_random_walk);
  teller.copy("imu.accel_noise_density", info_imu.accel_noise_density, &imu.accel_noise_density);
  teller.copy("imu.accel_random_walk", info_imu.accel_random_walk, &imu.accel_random_walk);

  const RadarInfo& info = dataset.radar_info;
  tell_radar(info, &options->radar, teller);
  CalibrationOptions& prior = options->calibration;
  teller.copy_prior("calibration.rotation_sigma", info.prior_rotation, &prior.rotation_sigma);
  teller.copy_prior("calibration.translation_sigma", info.prior_position, &prior.translation_sigma);
  teller.copy_prior("calibration.time_offset_sigma", info.prior_time_offset,
                    &prior.time_offset_sigma);
  teller.copy_prior("calibration.doppler_scale_sigma", info.prior_doppler_scale,
                    &prior.doppler_scale_sigma);
}

}  // namespace

void apply_sensor_info(const Dataset& dataset, Options* options,
                       std::vector<std::string>* configured) {
  tell(dataset, options, {configured});
  apply_other_radars(dataset, options);
}

void apply_other_radars(const Dataset& dataset, Options* options) {
  options->other_radars.clear();
  for (const Dataset::OtherRadar& other : dataset.other_radars) {
    RadarOptions radar = options->radar;
    tell_radar(other.info, &radar, {nullptr});
    (void)options->other_radars.push_back(
        {radar.T_BS, radar.time_offset, radar.doppler_scale, radar});
  }
}

std::vector<std::string> sensor_option_keys() {
  std::vector<std::string> keys;
  Options scratch;
  tell({}, &scratch, {&keys, true});
  return keys;
}

}  // namespace rio::io

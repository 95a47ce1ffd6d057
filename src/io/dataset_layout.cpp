// SPDX-License-Identifier: BSD-3-Clause
#include "dataset_layout.hpp"

namespace rio::io {

std::vector<SensorKey> imu_keys(ImuInfo* info) {
  return {{"rate_hz", "Hz", 1.0, &info->rate_hz},
          {"gyroscope_noise_density", "rad/s/sqrt(Hz)", 1.0, &info->gyro_noise_density},
          {"gyroscope_random_walk", "rad/s^2/sqrt(Hz)", 1.0, &info->gyro_random_walk},
          {"accelerometer_noise_density", "m/s^2/sqrt(Hz)", 1.0, &info->accel_noise_density},
          {"accelerometer_random_walk", "m/s^3/sqrt(Hz)", 1.0, &info->accel_random_walk}};
}

std::vector<SensorKey> radar_keys(RadarInfo* info) {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  return {{"rate_hz", "Hz", 1.0, &info->rate_hz},
          {"max_range_m", "m", 1.0, &info->max_range},
          {"max_doppler_mps", "m/s", 1.0, &info->max_doppler},
          {"range_resolution_m", "m", 1.0, &info->range_resolution},
          {"doppler_resolution_mps", "m/s", 1.0, &info->doppler_resolution},
          {"fov_azimuth_deg", "", kDegree, &info->fov_azimuth},
          {"azimuth_fov_deg", "", kDegree, &info->fov_azimuth},
          {"fov_azimuth_rad", "rad", 1.0, &info->fov_azimuth},
          {"azimuth_fov_rad", "rad", 1.0, &info->fov_azimuth},
          {"fov_elevation_deg", "", kDegree, &info->fov_elevation},
          {"elevation_fov_deg", "", kDegree, &info->fov_elevation},
          {"fov_elevation_rad", "rad", 1.0, &info->fov_elevation},
          {"elevation_fov_rad", "rad", 1.0, &info->fov_elevation},
          {"sigma_range_m", "m", 1.0, &info->sigma_range},
          {"sigma_azimuth_deg", "", kDegree, &info->sigma_azimuth},
          {"sigma_azimuth_rad", "rad", 1.0, &info->sigma_azimuth},
          {"sigma_elevation_deg", "", kDegree, &info->sigma_elevation},
          {"sigma_elevation_rad", "rad", 1.0, &info->sigma_elevation},
          {"sigma_doppler_mps", "m/s", 1.0, &info->sigma_doppler},
          {"weak_snr_db", "dB", 1.0, &info->weak_snr_db, true},
          {"time_offset_s", "s", 1.0, &info->time_offset, true},
          {"doppler_scale", "", 1.0, &info->doppler_scale, true},
          {"prior_rotation_deg", "", kDegree, &info->prior_rotation},
          {"prior_rotation_rad", "rad", 1.0, &info->prior_rotation},
          {"prior_position_m", "m", 1.0, &info->prior_position},
          {"prior_time_offset_s", "s", 1.0, &info->prior_time_offset},
          {"prior_doppler_scale", "", 1.0, &info->prior_doppler_scale}};
}

}  // namespace rio::io

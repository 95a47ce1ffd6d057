// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/flight_dataset.hpp"

namespace rio::io {

RadarInfo radar_info_of(const sim::RadarModel& model, const Pose& configured_T_BS) {
  RadarInfo info;
  info.T_BS = configured_T_BS;
  info.rate_hz = model.rate_hz;
  info.max_range = model.max_range;
  info.fov_azimuth = model.fov_azimuth;
  info.fov_elevation = model.fov_elevation;
  info.sigma_range = model.sigma_range;
  info.sigma_azimuth = model.sigma_azimuth;
  info.sigma_elevation = model.sigma_elevation;
  info.sigma_doppler = model.sigma_doppler;
  if (model.ambiguous) info.max_doppler = model.reported_max_doppler();
  info.range_resolution = model.quantize ? model.range_resolution : 0.0;
  info.doppler_resolution = model.reported_doppler_resolution();
  return info;
}

Dataset dataset_of(const sim::Flight& flight) {
  Dataset dataset;
  dataset.imu = flight.imu;
  dataset.scans = flight.scans;
  dataset.ground_truth = flight.truth;
  const sim::ImuModel& imu = flight.scenario.imu;
  dataset.imu_info = {.rate_hz = imu.rate_hz,
                      .gyro_noise_density = imu.gyro_noise_density,
                      .gyro_random_walk = imu.gyro_random_walk,
                      .accel_noise_density = imu.accel_noise_density,
                      .accel_random_walk = imu.accel_random_walk};
  dataset.radar_info = radar_info_of(flight.scenario.radar, flight.configured_T_BS);
  return dataset;
}

}  // namespace rio::io

// SPDX-License-Identifier: BSD-3-Clause
// Flies a simulated flight through door 1 and keeps what the tests need.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "rio/eval/stamped_pose.hpp"
#include "rio/rio.hpp"
#include "rio/sim/flight.hpp"

namespace rio::test {

/// Options of a preset with the sensor noises and the mounting of a simulated flight.
inline Options options_for(const sim::Flight& flight, const std::string& name) {
  Options o;
  EXPECT_TRUE(preset(name, &o));
  const sim::ImuModel& imu = flight.imu_model;
  o.imu.gyro_noise_density = imu.gyro_noise_density;
  o.imu.gyro_random_walk = imu.gyro_random_walk;
  o.imu.accel_noise_density = imu.accel_noise_density;
  o.imu.accel_random_walk = imu.accel_random_walk;
  const sim::RadarModel& radar = flight.radar_model;
  o.radar.T_BS = radar.T_BS;
  o.radar.sigma_range = radar.sigma_range;
  o.radar.sigma_azimuth = radar.sigma_azimuth;
  o.radar.sigma_elevation = radar.sigma_elevation;
  o.radar.sigma_doppler = radar.sigma_doppler;
  o.radar.range_resolution = radar.quantize ? radar.range_resolution : 0.0;
  o.radar.doppler_resolution = radar.quantize ? radar.doppler_resolution : 0.0;
  return o;
}

/// Estimate, truth and covariance at one processed scan.
struct Step {
  NavState estimate;
  NavState truth;
  BodyCovariance covariance;
};

/// True state of a flight at any stamp; the biases are those of the latest IMU sample.
inline NavState truth_at(const sim::Flight& flight, Time time) {
  NavState truth = flight.trajectory.at(time).nav;
  const double seconds = to_seconds(time - flight.truth.front().time);
  const auto index = static_cast<std::size_t>(seconds * flight.imu_model.rate_hz);
  const NavState& sample = flight.truth[std::min(index, flight.truth.size() - 1)];
  truth.gyro_bias = sample.gyro_bias;
  truth.accel_bias = sample.accel_bias;
  return truth;
}

/// Feeds all data in the order of the stamps; one Step per processed scan.
/// @param each called after every scan taken, if given
inline std::vector<Step> replay(const sim::Flight& flight, Odometry& odometry,
                                const std::function<void(const UpdateReport&)>& each = {}) {
  std::vector<Step> steps;
  std::size_t next = 0;
  for (const ImuSample& sample : flight.imu) {
    EXPECT_EQ(odometry.add_imu(sample), Status::kOk);
    for (; next < flight.scans.size() && flight.scans[next].time <= sample.time; ++next) {
      if (odometry.add_scan(flight.scans[next]) != Status::kOk) continue;
      const NavState& x = odometry.at_scan();
      steps.push_back({x, truth_at(flight, x.time), odometry.covariance()});
      if (each) each(odometry.report());
    }
  }
  return steps;
}

/// Positions and attitudes of the estimate, or of the truth.
inline std::vector<eval::StampedPose> poses(const std::vector<Step>& steps, bool truth) {
  std::vector<eval::StampedPose> out;
  for (const Step& step : steps) {
    const NavState& x = truth ? step.truth : step.estimate;
    out.push_back({x.time, x.p_WB, x.q_WB});
  }
  return out;
}

}  // namespace rio::test

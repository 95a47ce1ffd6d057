// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "rio/sim/flight.hpp"

namespace rio::test {

/// Every number that a user of the flight sees, and the stamps in seconds after its start.
inline std::vector<double> numbers_of(const sim::Flight& flight) {
  std::vector<double> all;
  const auto add = [&](const Vector3d& v) { all.insert(all.end(), {v.x(), v.y(), v.z()}); };
  const auto seconds = [&](Time time) { return to_seconds(time - flight.trajectory.start()); };
  for (const ImuSample& sample : flight.imu) {
    all.push_back(seconds(sample.time));
    add(sample.gyro_B);
    add(sample.accel_B);
  }
  for (const NavState& truth : flight.truth) {
    all.push_back(seconds(truth.time));
    add(truth.p_WB);
    add(truth.v_WB);
    add(truth.q_WB.vec());
    add(truth.gyro_bias);
    add(truth.accel_bias);
  }
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    all.push_back(seconds(flight.scans[i].time));
    all.push_back(seconds(flight.arrivals[i]));
    for (std::size_t k = 0; k < flight.scans[i].detections.size(); ++k) {
      const RadarDetection& detection = flight.scans[i].detections[k];
      add(detection.point_S);
      add({detection.range_rate, detection.snr_db, detection.noise_db});
      all.push_back(flight.labels[i][k].reflector);
    }
  }
  add(flight.configured_T_BS.translation);
  add(flight.configured_T_BS.rotation.vec());
  return all;
}

}  // namespace rio::test

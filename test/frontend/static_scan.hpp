// SPDX-License-Identifier: BSD-3-Clause
// Points of a room that stands still, as a radar sees them that moves at a known velocity.
#pragma once

#include <cmath>
#include <vector>

#include "rio/models/detection.hpp"
#include "support/random_state.hpp"

namespace rio::test {

/// The range rate of a static point: it approaches with the component of the velocity towards it.
inline double static_rate(const RadarDetection& d, const Vector3d& v_S) {
  return -d.point_S.normalized().dot(v_S);
}

/// Points over 120 x 60 degrees in the ranges of a room.
/// @param sigma of the range rates [m/s]
inline std::vector<RadarDetection> static_points(Random& random, int count, const Vector3d& v_S,
                                                 double sigma = 0.0) {
  std::vector<RadarDetection> out(static_cast<std::size_t>(count));
  for (RadarDetection& d : out) {
    const double az = random.uniform(-1.05, 1.05);
    const double el = random.uniform(-0.52, 0.52);
    d.point_S = random.uniform(1.0, 8.0) *
                Vector3d(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
    d.range_rate = static_rate(d, v_S) + random.normal(sigma);
  }
  return out;
}

/// A radar without errors of the angles.
inline RadarOptions exact_angles() {
  RadarOptions o;
  o.sigma_doppler = 0.03;
  o.sigma_azimuth = o.sigma_elevation = 0.0;
  return o;
}

inline DetectionList list_of(const std::vector<RadarDetection>& raw,
                             const RadarOptions& radar = exact_angles(), Time time = Time(1)) {
  RadarScan scan;
  scan.time = time;
  scan.detections = raw;
  DetectionList out;
  filter_detections(scan, radar, static_cast<int>(kMaxDetections), out);
  return out;
}

}  // namespace rio::test

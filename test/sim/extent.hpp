// SPDX-License-Identifier: BSD-3-Clause
// Extremes of a path.
#pragma once

#include <algorithm>
#include <cmath>

#include "rio/sim/trajectory.hpp"

namespace rio::sim {

struct Extent {
  Vector3d low = Vector3d::Constant(1e9);    ///< [m]
  Vector3d high = Vector3d::Constant(-1e9);  ///< [m]
  double fastest = 0.0;                      ///< [m/s]
  double turn_rate = 0.0;                    ///< largest about z [rad/s]
};
/// Between two instants [s].
inline Extent extent(const Trajectory& trajectory, double begin, double end) {
  Extent extent;
  for (double t = begin; t < end; t += 0.01) {
    const Trajectory::Point point = trajectory.at(t);
    extent.low = extent.low.cwiseMin(point.nav.p_WB);
    extent.high = extent.high.cwiseMax(point.nav.p_WB);
    extent.fastest = std::max(extent.fastest, point.nav.v_WB.norm());
    extent.turn_rate = std::max(extent.turn_rate, std::abs(point.gyro_B.z()));
  }
  return extent;
}
/// Of all of it.
inline Extent extent(const Trajectory& trajectory) {
  return extent(trajectory, 0.0, trajectory.duration());
}

}  // namespace rio::sim

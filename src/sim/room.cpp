// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/room.hpp"

#include <cmath>

namespace rio::sim {

RoomOptions grown(RoomOptions options, const Vector3d& path_low, const Vector3d& path_high) {
  constexpr double kBelow = 0.35;  // landing gear [m]
  constexpr double kAside = 1.0;
  options.low_W = options.low_W.cwiseMin(path_low - Vector3d(kAside, kAside, kBelow));
  options.high_W = options.high_W.cwiseMax(path_high + Vector3d::Constant(kAside));
  return options;
}

Room make_room(std::uint64_t seed, const RoomOptions& options) {
  Random random(seed, 3);
  const Vector3d& low = options.low_W;
  const Vector3d& high = options.high_W;
  Room room{.low_W = low, .high_W = high, .reflectors = {}};
  const auto add = [&](const Vector3d& position, double rcs) {
    const double rcs_dbsm = rcs + options.rcs_sigma_db * random.normal();
    room.reflectors.push_back({position, rcs_dbsm, random.uniform()});
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      const double area = (high - low).prod() / (high - low)[axis];
      const double density = axis < 2 ? options.wall_density
                             : upper  ? options.ceiling_density
                                      : options.floor_density;
      for (long i = std::lround(area * density); i > 0; --i) {
        Vector3d position = random.in_box(low, high);
        position[axis] = upper ? high[axis] : low[axis];
        add(position, options.surface_rcs_dbsm);
      }
    }
  }
  const double half = options.mat_half_width;
  for (long i = std::lround(4.0 * half * half * options.mat_density); i > 0; --i) {
    add(random.in_box({-half, -half, low.z()}, {half, half, low.z()}), options.mat_rcs_dbsm);
  }
  const double floor_area = (high - low).head<2>().prod();
  for (long i = 0; i < std::lround(floor_area * options.clutter_density); ++i) {
    Vector3d position = random.in_box(low, high);
    // three quarters within a metre of a wall, below 1.2 m
    if (i % 4 != 0) {
      const auto axis = static_cast<int>(i % 2);
      const double depth = random.uniform();
      position[axis] = i % 8 < 4 ? low[axis] + depth : high[axis] - depth;
      position.z() = low.z() + 1.2 * random.uniform();
    }
    add(position, options.clutter_rcs_dbsm);
  }
  return room;
}

}  // namespace rio::sim

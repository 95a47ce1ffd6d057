// SPDX-License-Identifier: BSD-3-Clause
// A room of point reflectors, the world the simulated radar looks at. Frame W, metres.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "rio/sim/random.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// A static scattering centre.
struct Reflector {
  Vector3d position_W = Vector3d::Zero();  ///< [m]
  double rcs_dbsm = 0.0;                   ///< radar cross section [dB(m^2)]
  /// Susceptibility to multipath, 0..1: of those in view, the lowest throw ghosts, so that ghosts
  /// last as long as the view does.
  double ghost_rank = 1.0;
};

/// A box of six flat mirrors and the reflectors in it.
struct Room {
  Vector3d low_W = Vector3d::Zero();   ///< corner of smallest coordinates [m]
  Vector3d high_W = Vector3d::Zero();  ///< corner of largest coordinates [m]
  std::vector<Reflector> reflectors;
};

/// How a room is furnished. Cross sections are mean and standard deviation of a normal law in dB.
struct RoomOptions {
  Vector3d low_W{-4.0, -3.5, -0.35};  ///< the floor lies one landing gear below the start [m]
  Vector3d high_W{4.0, 3.5, 2.75};    ///< [m]
  double floor_density = 14.0;        ///< [1/m^2]
  double wall_density = 8.0;          ///< [1/m^2]
  double ceiling_density = 4.0;       ///< [1/m^2]
  double mat_density = 100.0;         ///< fine texture of the floor where take-off happens [1/m^2]
  double mat_half_width = 2.0;        ///< of its square about the origin [m]
  double clutter_density = 2.7;  ///< furniture and fittings, mostly near walls [1/m^2 of floor]
  double surface_rcs_dbsm = -32.0;
  double mat_rcs_dbsm = -44.0;  ///< shows from nearby only
  double clutter_rcs_dbsm = -20.0;
  double rcs_sigma_db = 5.0;
};

/// The options with the room made large enough for a path that stays between two corners.
inline RoomOptions grown(RoomOptions options, const Vector3d& path_low, const Vector3d& path_high) {
  constexpr double kBelow = 0.35;  // landing gear [m]
  constexpr double kAside = 1.0;
  options.low_W = options.low_W.cwiseMin(path_low - Vector3d(kAside, kAside, kBelow));
  options.high_W = options.high_W.cwiseMax(path_high + Vector3d::Constant(kAside));
  return options;
}

/// The room of a seed.
inline Room make_room(std::uint64_t seed, const RoomOptions& options = {}) {
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

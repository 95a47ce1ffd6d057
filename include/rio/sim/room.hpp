// SPDX-License-Identifier: BSD-3-Clause
// A room of point reflectors, the environment of the simulated radar. Frame W, metres.
#pragma once

#include <cstdint>
#include <vector>

#include "rio/sim/random.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// A static scattering centre.
struct Reflector {
  Vector3d position_W = Vector3d::Zero();  ///< [m]
  double rcs_dbsm = 0.0;                   ///< radar cross section [dB(m^2)]
  /// Susceptibility to multipath, 0..1: of those in view, the lowest cause ghosts, so that a ghost
  /// lasts as long as its reflector is in view.
  double ghost_rank = 1.0;
};

/// A box of six flat mirrors and the reflectors in it.
struct Room {
  Vector3d low_W = Vector3d::Zero();   ///< corner of smallest coordinates [m]
  Vector3d high_W = Vector3d::Zero();  ///< corner of largest coordinates [m]
  std::vector<Reflector> reflectors;
};

/// Furnishing of a room. Cross sections are mean and standard deviation of a normal law in dB.
struct RoomOptions {
  Vector3d low_W{-4.0, -3.5, -0.35};  ///< the floor is one landing gear below the start [m]
  Vector3d high_W{4.0, 3.5, 2.75};    ///< [m]
  double floor_density = 14.0;        ///< [1/m^2]
  double wall_density = 8.0;          ///< [1/m^2]
  double ceiling_density = 4.0;       ///< [1/m^2]
  double mat_density = 100.0;         ///< fine texture of the floor at take-off [1/m^2]
  double mat_half_width = 2.0;        ///< of its square about the origin [m]
  double clutter_density = 2.7;  ///< furniture and fittings, mostly near walls [1/m^2 of floor]
  double surface_rcs_dbsm = -32.0;
  double mat_rcs_dbsm = -44.0;  ///< visible from nearby only
  double clutter_rcs_dbsm = -20.0;
  double rcs_sigma_db = 5.0;
};

/// The options with the room enlarged for a path that stays between two corners.
RoomOptions grown(RoomOptions options, const Vector3d& path_low, const Vector3d& path_high);

/// The room of a seed.
Room make_room(std::uint64_t seed, const RoomOptions& options = {});

}  // namespace rio::sim

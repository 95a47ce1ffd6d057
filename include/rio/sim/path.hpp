// SPDX-License-Identifier: BSD-3-Clause
// Random flights through a box: zigzag legs, up and down in turn, between two standstills. The same
// rules give a hover (a small box, slow legs), a race through a hall, and a long flight outdoors. A
// vehicle on the ground drives forward from way point to way point instead, and stops when its
// length is reached. Frame W: the origin is the start, level and at yaw 0.
#pragma once

#include <cstdint>
#include <string>

#include "rio/sim/random.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// Region and course of a flight. Defaults: a small quadrotor flown by hand in a room.
struct PathOptions {
  std::string file{};              ///< recorded path to fly instead (TUM, or EuRoC csv)
  bool ground = false;             ///< drives on level ground; heights of the box are ignored
  double length = 150.0;           ///< of the whole path [m]; 0 = the flight ends by `duration`
  double duration = 120.0;         ///< if length is 0: time before the flight returns [s]
  Vector3d low{-3.0, -2.5, 0.35};  ///< corner of the box of way points [m]
  Vector3d high{3.0, 2.5, 1.7};    ///< opposite corner [m]
  Vector3d reach{2.5, 2.5, 10.0};  ///< longest leg along each axis; short legs turn often [m]
  double min_speed = 0.45;         ///< of a leg [m/s]
  double max_speed = 1.43;         ///< of a leg [m/s]
  double min_leg = 1.5;            ///< a leg ends at its target or after a time in ... [s]
  double max_leg = 4.0;            ///< ... [min_leg, max_leg] [s]
  double max_yaw = 1.75;      ///< range of the yaw swing, plus and minus; not on the ground [rad]
  double max_yaw_rate = 1.0;  ///< of the swing, at least 0.3 of it; turn rate on the ground [rad/s]
  double knot_spacing = 0.5;  ///< of the spline; longer is smoother [s]
  double fit_spacing = 0.2;   ///< the same for a recorded path; trajectory_fit.hpp [s]
  double stand_before = 4.0;  ///< standstill before take-off [s]
  double stand_after = 2.0;   ///< standstill after landing [s]
};

/// A flight from the seed: take-off to 0.4 of the height of the box, legs, landing 0.3 to 1 m from
/// the start; or a drive, which does not return. `options.file` is ignored.
Trajectory random_flight(std::uint64_t seed, const PathOptions& options = {}, Time start = Time(0));

}  // namespace rio::sim

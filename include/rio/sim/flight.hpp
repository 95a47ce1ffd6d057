// SPDX-License-Identifier: BSD-3-Clause
// A complete simulated flight: the data of the IMU and the radar, and the truth about both.
// Deterministic: the same scenario gives the same bytes. Scan stamps never equal IMU stamps.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/sim/imu.hpp"
#include "rio/sim/path.hpp"
#include "rio/sim/radar.hpp"
#include "rio/sim/random.hpp"
#include "rio/sim/room.hpp"
#include "rio/sim/scenario.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// Sensor data and truth on the clock of the IMU.
struct Flight {
  Scenario scenario;
  Trajectory trajectory;                   ///< truth at any instant, biases zero
  Room room;                               ///< index space of Label::reflector
  Pose configured_T_BS;                    ///< mounting configured in the estimator
  std::vector<ImuSample> imu;              ///< stamps strictly increase
  std::vector<RadarScan> scans;            ///< by increasing stamp
  std::vector<Time> arrivals;              ///< arrival time of each scan
  std::vector<std::vector<Label>> labels;  ///< one per detection, same order as the scans
  std::vector<NavState> truth;  ///< one per period of the IMU, gaps included, with biases

  /// True state at any stamp; the biases are those of the latest period of the IMU.
  NavState truth_at(Time time) const;
  /// The first state with the start errors of the scenario, biases unknown.
  NavState configured_start() const;
};

/// The true mounting with the errors of Scenario::errors, axis and direction from the seed.
Pose configured_mounting(const Scenario& scenario);

/// Moves the sensors along `trajectory` through a room that is large enough for it.
/// @param each called before every scan with its number and the number of scans
Flight simulate_flight(const Trajectory& trajectory, const Scenario& scenario,
                       const std::function<void(std::size_t, std::size_t)>& each = {});

/// A random flight of the scenario; its `path.file` is ignored.
inline Flight simulate_flight(const Scenario& scenario = {}) {
  return simulate_flight(random_flight(scenario.seed, scenario.path, scenario.start), scenario);
}

}  // namespace rio::sim

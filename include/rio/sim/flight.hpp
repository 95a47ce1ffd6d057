// SPDX-License-Identifier: BSD-3-Clause
// A whole simulated flight: what the IMU and the radar report, and the truth about both.
// Deterministic: the same scenario gives the same bytes. Scan stamps never equal IMU stamps.
#pragma once

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
  Room room;                               ///< what Label::reflector counts in
  Pose configured_T_BS;                    ///< mounting as the estimator has it
  std::vector<ImuSample> imu;              ///< stamps strictly increase
  std::vector<RadarScan> scans;            ///< by increasing stamp
  std::vector<Time> arrivals;              ///< when each scan is at hand
  std::vector<std::vector<Label>> labels;  ///< one a detection, same order as the scans
  std::vector<NavState> truth;             ///< one a period of the IMU, gaps included, with biases

  /// True state at any stamp; the biases are those of the latest period of the IMU.
  NavState truth_at(Time time) const;
  /// The first one with the errors of the scenario's start, biases unknown.
  NavState configured_start() const;
};

/// The true mounting with the errors of Scenario::told, axis and direction from the seed.
Pose configured_mounting(const Scenario& scenario);

/// Carries the sensors along `trajectory` through a room that is large enough for it.
Flight simulate_flight(const Trajectory& trajectory, const Scenario& scenario);

/// A random flight of the scenario; its `path.file` is not looked at.
inline Flight simulate_flight(const Scenario& scenario = {}) {
  return simulate_flight(random_flight(scenario.seed, scenario.path, scenario.start), scenario);
}

}  // namespace rio::sim

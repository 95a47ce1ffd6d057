// SPDX-License-Identifier: BSD-3-Clause
// A complete scenario of a simulated flight: path, sensors, surroundings, disturbances, and wrong
// configurations of the estimator. The fields with units: scenario_fields.hpp; the named scenarios:
// catalogue.hpp.
#pragma once

#include <cstdint>
#include <limits>

#include "rio/sim/imu.hpp"
#include "rio/sim/path.hpp"
#include "rio/sim/radar_model.hpp"
#include "rio/sim/room.hpp"
#include "rio/sim/spells.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// Temporary disturbances. Spells of different kinds with equal counts coincide.
struct Disturbances {
  Spells bursts;    ///< many outliers; RadarModel::burst_outlier_share
  Spells outages;   ///< the radar is silent
  Spells imu_gaps;  ///< the IMU is silent
};

/// Wrong configuration of the estimator.
struct ConfigurationErrors {
  double extrinsic_angle = 0.0;     ///< error of the mounting about a random axis [rad]
  double extrinsic_distance = 0.0;  ///< error of the lever arm in a random direction [m]
  /// Error of the velocity of the start [m/s], and of its attitude, about the body's x axis [rad].
  /// If one is not zero, the estimator starts at the first IMU sample from the true state plus
  /// these errors; if both are zero, it aligns itself at standstill.
  Vector3d start_velocity = Vector3d::Zero();
  double start_tilt = 0.0;
  double start_velocity_sigma = 0.05;  ///< configured sigma of the start velocity, per axis [m/s]

  bool starts_wrongly() const { return !start_velocity.isZero() || start_tilt != 0.0; }
};

/// One kind of flight. The seed varies path, room and noise.
struct Scenario {
  std::uint64_t seed = 1;
  PathOptions path{};
  ImuModel imu{};
  RadarModel radar{};
  RoomOptions room{};
  Disturbances disturbances{};
  ConfigurationErrors errors{};                                   ///< "told" in scenario files
  double max_duration = std::numeric_limits<double>::infinity();  ///< the flight is cut here [s]
  Time start{1'700'000'000'000'000'000};                          ///< stamp of the first IMU sample

  /// Sensors that obey a filter's model exactly, for consistency tests.
  static Scenario ideal() {
    Scenario scenario;
    scenario.imu = ImuModel::ideal();
    scenario.radar = RadarModel::ideal();
    return scenario;
  }
};

}  // namespace rio::sim

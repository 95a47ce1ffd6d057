// SPDX-License-Identifier: BSD-3-Clause
// A whole simulated flight: what the IMU and the radar report, and the truth about both.
// Deterministic: the same options give the same bytes. Scan stamps never equal IMU stamps.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "rio/sim/imu.hpp"
#include "rio/sim/radar.hpp"
#include "rio/sim/room.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// What to simulate.
struct FlightOptions {
  std::uint64_t seed = 1;
  double length_m = 150.0;  ///< of the flown path [m], at least 20
  double max_duration = std::numeric_limits<double>::infinity();  ///< the flight is cut here [s]
  Time start{1'700'000'000'000'000'000};                          ///< stamp of the first IMU sample
  ImuModel imu{};
  RadarModel radar{};
  RoomOptions room{};

  /// Sensors that obey a filter's model exactly, for consistency tests.
  static FlightOptions ideal() {
    FlightOptions options;
    options.imu = ImuModel::ideal();
    options.radar = RadarModel::ideal();
    return options;
  }
};

/// Sensor data and truth on one clock.
struct Flight {
  std::vector<ImuSample> imu;
  std::vector<RadarScan> scans;
  std::vector<std::vector<Label>> labels;  ///< one a detection, same order as the scans
  std::vector<NavState> truth;             ///< one an IMU sample, with the biases in it
  Trajectory trajectory;                   ///< truth at any stamp, biases zero
  Room room;                               ///< what Label::reflector counts in
  ImuModel imu_model;
  RadarModel radar_model;
};

/// Carries the sensors along `trajectory` through a room.
inline Flight simulate_flight(const Trajectory& trajectory, const FlightOptions& options) {
  // the radar's clock starts between two IMU samples and its period is no multiple of theirs
  constexpr Time kFirstScan{23'456'789};
  Flight flight{.imu = {},
                .scans = {},
                .labels = {},
                .truth = {},
                .trajectory = trajectory,
                .room = make_room(options.seed, options.room),
                .imu_model = options.imu,
                .radar_model = options.radar};
  const double seconds = std::min(trajectory.duration(), options.max_duration);
  const Time end = trajectory.start() + from_seconds(seconds);

  ImuSimulator imu(options.imu, options.seed);
  for (std::int64_t i = 0;; ++i) {
    const Time time =
        trajectory.start() + from_seconds(static_cast<double>(i) / options.imu.rate_hz);
    if (time > end) break;
    const Trajectory::Point point = trajectory.at(time);
    flight.truth.push_back(point.nav);
    flight.truth.back().gyro_bias = imu.gyro_bias();
    flight.truth.back().accel_bias = imu.accel_bias();
    flight.imu.push_back(imu.sample(point));
  }

  RadarSimulator radar(options.radar, flight.room, options.seed);
  for (std::int64_t i = 0;; ++i) {
    const Time time = trajectory.start() + kFirstScan +
                      from_seconds(static_cast<double>(i) / options.radar.rate_hz);
    if (flight.imu.empty() || time > flight.imu.back().time) break;
    LabeledScan labeled = radar.scan(trajectory.at(time));
    flight.scans.push_back(std::move(labeled.scan));
    flight.labels.push_back(std::move(labeled.labels));
  }
  return flight;
}

/// An indoor flight of the seed and length of the options.
inline Flight simulate_flight(const FlightOptions& options = {}) {
  return simulate_flight(indoor_flight(options.seed, options.length_m, options.start), options);
}

}  // namespace rio::sim

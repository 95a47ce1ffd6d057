// SPDX-License-Identifier: BSD-3-Clause
// A whole simulated flight: what the IMU and the radar report, and the truth about both.
// Deterministic: the same scenario gives the same bytes. Scan stamps never equal IMU stamps.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>
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
  Pose told_T_BS;                          ///< mounting as the estimator is told
  std::vector<ImuSample> imu;              ///< stamps strictly increase
  std::vector<RadarScan> scans;            ///< by increasing stamp
  std::vector<Time> arrivals;              ///< when each scan is at hand
  std::vector<std::vector<Label>> labels;  ///< one a detection, same order as the scans
  std::vector<NavState> truth;             ///< one a period of the IMU, gaps included, with biases

  /// True state at any stamp; the biases are those of the latest period of the IMU.
  NavState truth_at(Time time) const {
    NavState state = trajectory.at(time).nav;
    const auto later = std::upper_bound(truth.begin(), truth.end(), time,
                                        [](Time t, const NavState& next) { return t < next.time; });
    const NavState& period = later == truth.begin() ? truth.front() : *std::prev(later);
    state.gyro_bias = period.gyro_bias;
    state.accel_bias = period.accel_bias;
    return state;
  }
};

namespace flight_detail {

/// The true mounting with the errors of `told`, axis and direction from the seed.
inline Pose told_mounting(const Scenario& scenario) {
  Random random(scenario.seed, 7);
  const Vector3d axis = random.normal3().normalized();
  const Vector3d direction = random.normal3().normalized();
  const Pose& T_BS = scenario.radar.T_BS;
  return {(T_BS.rotation * quaternion_exp(scenario.told.extrinsic_angle * axis)).normalized(),
          T_BS.translation + scenario.told.extrinsic_distance * direction};
}

inline void fly_imu(double seconds, Flight* flight) {
  const ImuModel& model = flight->scenario.imu;
  const double period = 1.0 / model.rate_hz;
  ImuSimulator imu(model, flight->scenario.seed);
  Random jitter(flight->scenario.seed, 8);
  for (std::int64_t i = 0;; ++i) {
    const double t = static_cast<double>(i) * period;
    const Time time = flight->trajectory.start() + from_seconds(t);
    if (time > flight->trajectory.start() + from_seconds(seconds)) break;
    const Trajectory::Point point = flight->trajectory.at(time);
    flight->truth.push_back(point.nav);
    flight->truth.back().gyro_bias = imu.gyro_bias();
    flight->truth.back().accel_bias = imu.accel_bias();
    ImuSample sample = imu.sample(point);
    // less than half a period, so that no sample overtakes another
    const double late =
        std::clamp(model.stamp_jitter * jitter.normal(), -0.49 * period, 0.49 * period);
    sample.time += from_seconds(late);
    if (flight->scenario.disturbances.imu_gaps.contain(t, seconds)) continue;
    flight->imu.push_back(sample);
  }
}

inline void fly_radar(double seconds, Flight* flight) {
  // the radar's clock starts between two IMU samples and its period is no multiple of theirs
  constexpr Time kFirstScan{23'456'789};
  const RadarModel& model = flight->scenario.radar;
  const Disturbances& disturbances = flight->scenario.disturbances;
  RadarSimulator radar(model, flight->room, flight->scenario.seed);
  for (std::int64_t i = 0;; ++i) {
    const Time since = kFirstScan + from_seconds(static_cast<double>(i) / model.rate_hz);
    const Time time = flight->trajectory.start() + since;
    const Time stamp = time + from_seconds(model.stamp_offset);
    if (flight->imu.empty() || std::max(time, stamp) > flight->imu.back().time) break;
    const double t = to_seconds(since);
    if (disturbances.outages.contain(t, seconds)) continue;
    const double outlier_share =
        disturbances.bursts.contain(t, seconds) ? model.burst_outlier_share : model.outlier_share;
    LabeledScan labeled = radar.scan(flight->trajectory.at(time), outlier_share);
    labeled.scan.time = stamp;
    flight->scans.push_back(std::move(labeled.scan));
    flight->arrivals.push_back(time + from_seconds(model.latency));
    flight->labels.push_back(std::move(labeled.labels));
  }
}

}  // namespace flight_detail

/// Carries the sensors along `trajectory` through a room that is large enough for it.
inline Flight simulate_flight(const Trajectory& trajectory, const Scenario& scenario) {
  Flight flight;
  flight.scenario = scenario;
  flight.trajectory = trajectory;
  flight.room = make_room(scenario.seed, grown(scenario.room, trajectory.low(), trajectory.high()));
  flight.told_T_BS = flight_detail::told_mounting(scenario);
  const double seconds = std::min(trajectory.duration(), scenario.max_duration);
  flight_detail::fly_imu(seconds, &flight);
  flight_detail::fly_radar(seconds, &flight);
  return flight;
}

/// A random flight of the scenario; its `path.file` is not looked at.
inline Flight simulate_flight(const Scenario& scenario = {}) {
  return simulate_flight(random_flight(scenario.seed, scenario.path, scenario.start), scenario);
}

}  // namespace rio::sim

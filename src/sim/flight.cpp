// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/flight.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

namespace rio::sim {

namespace {

/// Removes lost samples, or interpolates them between the neighbours; the first and the last sample
/// are kept.
void lose(std::vector<bool> is_lost, bool filled, std::vector<ImuSample>* imu) {
  if (imu->empty()) return;
  is_lost.front() = is_lost.back() = false;
  std::vector<ImuSample> kept;
  std::size_t last = 0;  // last received sample
  for (std::size_t i = 0; i < imu->size(); ++i) {
    if (is_lost[i]) continue;
    const ImuSample& from = (*imu)[last];
    const ImuSample& to = (*imu)[i];
    for (std::size_t k = last + 1; filled && k < i; ++k) {
      const double share = to_seconds((*imu)[k].time - from.time) / to_seconds(to.time - from.time);
      kept.push_back({.time = (*imu)[k].time,
                      .gyro_B = from.gyro_B + share * (to.gyro_B - from.gyro_B),
                      .accel_B = from.accel_B + share * (to.accel_B - from.accel_B)});
    }
    kept.push_back(to);
    last = i;
  }
  *imu = std::move(kept);
}

void fly_imu(double seconds, Flight* flight) {
  const ImuModel& model = flight->scenario.imu;
  const double period = 1.0 / model.rate_hz;
  ImuSimulator imu(model, flight->scenario.seed);
  Random jitter(flight->scenario.seed, 8);
  Losses losses(model, flight->scenario.seed);
  std::vector<bool> is_lost;
  for (std::int64_t i = 0;; ++i) {
    const double t = static_cast<double>(i) * period;
    const Time time = flight->trajectory.start() + from_seconds(t);
    if (time > flight->trajectory.start() + from_seconds(seconds)) break;
    const Trajectory::Point point = flight->trajectory.at(time);
    flight->truth.push_back(point.nav);
    flight->truth.back().gyro_bias = imu.gyro_bias();
    flight->truth.back().accel_bias = imu.accel_bias();
    ImuSample sample = imu.sample(point);
    // less than half a period, so that the order of samples is kept
    const double late =
        std::clamp(model.stamp_jitter * jitter.normal(), -0.49 * period, 0.49 * period);
    sample.time += from_seconds(late);
    const bool lost = losses.next();
    if (flight->scenario.disturbances.imu_gaps.contain(t, seconds)) continue;
    flight->imu.push_back(sample);
    is_lost.push_back(lost);
  }
  lose(is_lost, model.lost_filled, &flight->imu);
}

void fly_radar(double seconds, const std::function<void(std::size_t, std::size_t)>& each,
               Flight* flight) {
  // the radar's clock starts between two IMU samples and its period is not a multiple of theirs
  constexpr Time kFirstScan{23'456'789};
  const RadarModel& model = flight->scenario.radar;
  const Disturbances& disturbances = flight->scenario.disturbances;
  RadarSimulator radar(model, flight->room, flight->scenario.seed);
  Random loss(flight->scenario.seed, 14);
  const auto scans = static_cast<std::size_t>(seconds * model.rate_hz) + 1;
  for (std::int64_t i = 0;; ++i) {
    const Time since = kFirstScan + from_seconds(static_cast<double>(i) / model.rate_hz);
    const Time time = flight->trajectory.start() + since;
    const Time stamp = time + from_seconds(model.stamp_offset);
    if (flight->imu.empty() || std::max(time, stamp) > flight->imu.back().time) break;
    const double t = to_seconds(since);
    if (each) each(std::min(static_cast<std::size_t>(i), scans), scans);
    if (disturbances.outages.contain(t, seconds)) continue;
    const double outlier_share =
        disturbances.bursts.contain(t, seconds) ? model.burst_outlier_share : model.outlier_share;
    LabeledScan labeled = radar.scan(flight->trajectory.at(time), outlier_share);
    if (loss.uniform() < model.lost_share) continue;
    labeled.scan.time = stamp;
    flight->scans.push_back(std::move(labeled.scan));
    flight->arrivals.push_back(time + from_seconds(model.latency));
    flight->labels.push_back(std::move(labeled.labels));
  }
}

}  // namespace

Pose configured_mounting(const Scenario& scenario) {
  Random random(scenario.seed, 7);
  const Vector3d axis = random.normal3().normalized();
  const Vector3d direction = random.normal3().normalized();
  const Pose& T_BS = scenario.radar.T_BS;
  return {(T_BS.rotation * quaternion_exp(scenario.errors.extrinsic_angle * axis)).normalized(),
          T_BS.translation + scenario.errors.extrinsic_distance * direction};
}

NavState Flight::truth_at(Time time) const {
  NavState state = trajectory.at(time).nav;
  const auto later = std::upper_bound(truth.begin(), truth.end(), time,
                                      [](Time t, const NavState& next) { return t < next.time; });
  const NavState& period = later == truth.begin() ? truth.front() : *std::prev(later);
  state.gyro_bias = period.gyro_bias;
  state.accel_bias = period.accel_bias;
  return state;
}

NavState Flight::configured_start() const {
  const ConfigurationErrors& errors = scenario.errors;
  NavState state = truth.front();
  state.v_WB += errors.start_velocity;
  state.q_WB = (state.q_WB * quaternion_exp(errors.start_tilt * Vector3d::UnitX())).normalized();
  state.gyro_bias.setZero();
  state.accel_bias.setZero();
  return state;
}

Flight simulate_flight(const Trajectory& trajectory, const Scenario& scenario,
                       const std::function<void(std::size_t, std::size_t)>& each) {
  Flight flight;
  flight.scenario = scenario;
  flight.trajectory = trajectory;
  flight.room = make_room(scenario.seed, grown(scenario.room, trajectory.low(), trajectory.high()));
  flight.configured_T_BS = configured_mounting(scenario);
  const double seconds = std::min(trajectory.duration(), scenario.max_duration);
  fly_imu(seconds, &flight);
  fly_radar(seconds, each, &flight);
  return flight;
}

}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
#include "recorder.hpp"

namespace rio::python {

namespace {

std::array<double, 3> array_of(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

void Recorder::add(const Odometry& odometry) {
  add_state(odometry.at_scan(), odometry.covariance());
  add_scan(odometry.report());
  add_innovations(odometry.report(), &innovations);
  add_landmarks(odometry);
  add_events(odometry.report(), odometry.counters());
}

void Recorder::add_state(const NavState& state, const BodyCovariance& covariance) {
  const std::int64_t time = state.time.count();
  if (times.empty() || times.back() != time) {
    times.push_back(time);
    positions.emplace_back();
    orientations.emplace_back();
    velocities.emplace_back();
    gyro_biases.emplace_back();
    accel_biases.emplace_back();
    covariances.emplace_back();
  }
  positions.back() = array_of(state.p_WB);
  orientations.back() = wxyz(state.q_WB);
  velocities.back() = array_of(state.v_WB);
  gyro_biases.back() = array_of(state.gyro_bias);
  accel_biases.back() = array_of(state.accel_bias);
  Eigen::Map<Eigen::Matrix<double, body::kSize, body::kSize, Eigen::RowMajor>>(
      covariances.back().data()) = covariance;
}

void Recorder::add_scan(const UpdateReport& r) {
  const Vector3d& v = r.ego_velocity_S;
  scans.push_back({r.time.count(),
                   static_cast<std::uint8_t>(r.radar),
                   r.detections,
                   r.detections_kept,
                   r.static_detections,
                   {v.x(), v.y(), v.z()},
                   r.ego_velocity_valid,
                   r.trails,
                   r.clones,
                   r.landmarks,
                   r.landmarks_matched,
                   r.landmarks_added,
                   r.landmarks_removed,
                   r.at_rest,
                   static_cast<std::uint8_t>(r.health.state),
                   r.health.quality});
}

void Recorder::add_landmarks(const Odometry& odometry) {
  for (const LandmarkReport& l : odometry.landmarks()) {
    LandmarkRow row{odometry.report().time.count(), {}, {}, l.last_seen.count()};
    for (int i = 0; i < 3; ++i) {
      row.position[i] = l.position_W[i];
      for (int j = 0; j < 3; ++j) row.covariance[i][j] = l.covariance_W(i, j);
    }
    landmark_states.push_back(row);
  }
}

void Recorder::add_events(const UpdateReport& r, const Counters& counters) {
  const auto add = [&](const std::string& what, double value = 0.0) {
    events.push_back({r.time.count(), what, value});
  };
  if (scans.size() == 1) add("first scan");
  if (r.imu_gap) add("gap of the IMU");
  if (r.mounting_unknown) add("mounting unknown");
  if (r.velocity_reset) add("velocity replaced");
  if (r.attitude_reset) add("attitude or biases replaced");
  if (r.position_reopened > 0.0) add("position re-opened", r.position_reopened);
  if (counters.clock_restarts != clock_restarts_) add("clock of the sensors restarted");
  if (counters.restarts != restarts_) add("tilt lost and found again");
  if (r.at_rest != at_rest_) add(r.at_rest ? "rest begins" : "rest ends");
  if (r.health.state != health_) add(std::string("health: ") + to_string(r.health.state));
  clock_restarts_ = counters.clock_restarts;
  restarts_ = counters.restarts;
  at_rest_ = r.at_rest;
  health_ = r.health.state;
}

}  // namespace rio::python

// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the simulated radar share: plain radars, and the truth about a detection.
#pragma once

#include <cmath>
#include <vector>

#include "rio/sim/path.hpp"
#include "rio/sim/radar.hpp"

namespace rio::sim {

/// Exact measurements of every echo above the threshold.
inline RadarModel noise_free() {
  RadarModel model = RadarModel::ideal();
  model.sigma_range = model.sigma_azimuth = model.sigma_elevation = model.sigma_doppler = 0.0;
  model.fading_sigma_db = model.flicker_sigma_db = 0.0;
  return model;
}

/// Radar axes equal body axes, at the body origin.
inline RadarModel forward_looking(RadarModel model) {
  model.T_BS = Pose{};
  return model;
}

/// Nothing but six walls.
inline Room empty_room() {
  return {.low_W = {-4.0, -3.5, -0.35}, .high_W = {4.0, 3.5, 2.75}, .reflectors = {}};
}

inline const Vector3d& position(const Room& room, const Label& label) {
  return room.reflectors[static_cast<std::size_t>(label.reflector)].position_W;
}

/// The radar's own position and velocity and a point in its frame, from the body's motion.
inline Vector3d radar_position(const NavState& nav, const RadarModel& model) {
  return nav.p_WB + nav.q_WB * model.T_BS.translation;
}
inline Vector3d radar_velocity_S(const Trajectory::Point& body, const RadarModel& model) {
  const Vector3d v_B = body.nav.q_WB.conjugate() * body.nav.v_WB;
  return model.T_BS.rotation.conjugate() *
         Vector3d(v_B + body.gyro_B.cross(model.T_BS.translation));
}
inline Vector3d in_radar_frame(const Vector3d& point_W, const NavState& nav,
                               const RadarModel& model) {
  return model.T_BS.rotation.conjugate() *
         (nav.q_WB.conjugate() * (point_W - radar_position(nav, model)));
}
inline Vector3d in_world(const Vector3d& point_S, const NavState& nav, const RadarModel& model) {
  return radar_position(nav, model) + nav.q_WB * (model.T_BS.rotation * point_S);
}

inline constexpr double kScanPeriod = 1.0 / 15.0;  ///< [s]
inline constexpr double kTakeOff = 4.0;            ///< PathOptions::stand_before [s]

/// A scan and the true motion at it.
struct FlownScan {
  double seconds;
  Trajectory::Point body;
  LabeledScan result;
};

/// The scans of a flight; one seed for its path, its room and the radar.
inline std::vector<FlownScan> flown_scans(const RadarModel& model, std::uint64_t seed,
                                          double length = 60.0) {
  const Trajectory trajectory = random_flight(seed, {.length = length});
  RadarSimulator radar(model, make_room(seed), seed);
  std::vector<FlownScan> scans;
  for (double t = 0.0; t < trajectory.duration(); t += kScanPeriod) {
    const Trajectory::Point body = trajectory.at(t);
    scans.push_back({t, body, radar.scan(body)});
  }
  return scans;
}

inline double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}
inline double sigma_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace rio::sim

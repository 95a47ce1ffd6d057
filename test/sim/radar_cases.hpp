// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the simulated radar share: plain radars, and the truth about a detection.
#pragma once

#include <gtest/gtest.h>

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

/// Off the body origin, so that turns of the body move it.
inline RadarModel with_lever(RadarModel model) {
  model.T_BS.translation = {0.3, -0.2, 0.1};
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

/// The scans between two instants of a flight [s].
inline std::vector<FlownScan> scans_along(const Trajectory& trajectory, RadarSimulator radar,
                                          double begin, double end) {
  std::vector<FlownScan> scans;
  for (double t = begin; t < end; t += kScanPeriod) {
    const Trajectory::Point body = trajectory.at(t);
    scans.push_back({t, body, radar.scan(body)});
  }
  return scans;
}
/// Those of a whole flight; one seed for its path, its room and the radar.
inline std::vector<FlownScan> flown_scans(const RadarModel& model, std::uint64_t seed,
                                          double length = 60.0) {
  const Trajectory trajectory = random_flight(seed, {.length = length});
  return scans_along(trajectory, {model, make_room(seed), seed}, 0.0, trajectory.duration());
}

/// A detection of a scan with its label.
struct FlownDetection : RadarDetection, Label {
  double seconds;
  Trajectory::Point body;
};
inline std::vector<FlownDetection> detections_of(const std::vector<FlownScan>& scans) {
  std::vector<FlownDetection> all;
  for (const auto& [t, body, result] : scans) {
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      all.push_back({result.scan.detections[i], result.labels[i], t, body});
    }
  }
  return all;
}

/// The detections between 6 and 40 s of a flight; expects that they lie where they should and that
/// their range rates are the derivatives of the ranges.
/// @param place_W where what was detected is at `t` [s] for a radar at `p_W`: (d, t, p_W) -> [m]
inline constexpr double kCheckedFrom = 6.0;
template <class Place>
std::vector<FlownDetection> with_true_range_rates(const RadarModel& model, const Room& room,
                                                  const Place& place_W) {
  constexpr double kStep = 1e-4;
  const Trajectory trajectory = random_flight(6, {.length = 60.0});
  auto all = detections_of(scans_along(trajectory, {model, room, 6}, kCheckedFrom, 40.0));
  for (const FlownDetection& d : all) {
    const auto range = [&](double t) {
      const Vector3d p_W = radar_position(trajectory.at(t).nav, model);
      return (place_W(d, t, p_W) - p_W).norm();
    };
    const double rate = (range(d.seconds + kStep) - range(d.seconds - kStep)) / (2.0 * kStep);
    // truncation: kStep^2/6 times a third derivative below 1000; stamps in whole nanoseconds
    EXPECT_NEAR(d.range_rate, rate, 1e-5) << d.seconds;
    const Vector3d place = place_W(d, d.seconds, radar_position(d.body.nav, model));
    EXPECT_LT((d.point_S - in_radar_frame(place, d.body.nav, model)).norm(), 1e-9) << d.seconds;
  }
  return all;
}

}  // namespace rio::sim

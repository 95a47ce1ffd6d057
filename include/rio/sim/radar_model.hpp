// SPDX-License-Identifier: BSD-3-Clause
// The numbers of the simulated radar, its truth labels, polar coordinates and Doppler folding.
//
// (E1) point = r (cos el cos az, cos el sin az, sin el) in S
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "rio/types.hpp"

namespace rio::sim {

/// Mounted at the front and pitched 45 deg down.
inline Pose default_radar_mount() {
  const double half = std::numbers::pi / 8.0;
  return {.rotation = Quaternion(std::cos(half), 0.0, std::sin(half), 0.0),
          .translation = {0.10, 0.0, -0.05}};
}

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// The radar that is simulated. Defaults: AWR1843-like, indoor chirp.
struct RadarModel {
  Pose T_BS = default_radar_mount();        ///< pose of the radar in the body frame [m]
  double rate_hz = 15.0;                    ///< scans a second [Hz]
  double min_range = 0.15;                  ///< [m]
  double max_range = 16.28;                 ///< [m]
  double fov_azimuth = 120.0 * kDegree;     ///< full width [rad]
  double fov_elevation = 30.0 * kDegree;    ///< full height [rad]
  double range_resolution = 0.0394;         ///< cell and grid [m]
  double max_doppler = 1.51;                ///< unambiguous radial speed [m/s]
  double doppler_resolution = 1.51 / 16.0;  ///< cell and grid, 0.094 [m/s]
  bool quantize = true;                     ///< snap range and Doppler to their grids
  bool ambiguous = true;                    ///< fold the Doppler
  double sigma_range = 0.03;                ///< [m]
  double sigma_azimuth = 2.0 * kDegree;     ///< at boresight [rad]
  double sigma_elevation = 4.0 * kDegree;   ///< at boresight [rad]
  double sigma_doppler = 0.02;              ///< before the grid [m/s]
  double snr_1m_db = 53.0;                  ///< of 0 dBsm at 1 m on boresight [dB]
  double edge_loss_db = 6.0;                ///< two-way antenna loss at the edge of the view [dB]
  double threshold_db = 10.0;               ///< detection threshold [dB]
  double fading_sigma_db = 5.0;             ///< interference, changes as the radar moves [dB]
  double fading_distance = 0.15;            ///< e-folding distance of the fading and wander [m]
  double flicker_sigma_db = 0.7;            ///< changes with every scan [dB]
  double wander_sigma = 0.01;               ///< scattering centre about its mean, per axis [m]
  double outlier_share = 0.15;              ///< of all detections: ghosts and false alarms
  double false_alarm_share = 0.4;           ///< of the outliers; the others are ghosts
  int max_static = 34;                      ///< static detections kept, the strongest

  /// Only what a filter models: unbiased Gaussian noise on the polar coordinates and the Doppler.
  static RadarModel ideal() {
    RadarModel model;
    model.quantize = model.ambiguous = false;
    model.wander_sigma = model.outlier_share = 0.0;
    return model;
  }
};

/// What caused a detection.
enum class Cause : std::uint8_t {
  kStatic,        ///< a reflector, seen directly
  kMirror,        ///< its image behind a wall, below the floor or above the ceiling
  kDoubleBounce,  ///< twice to it and back: twice the range and the range rate
  kFalseAlarm,    ///< nothing: random place and Doppler
};

/// Name as in the label file.
inline const char* to_string(Cause cause) {
  switch (cause) {
    case Cause::kStatic:
      return "static";
    case Cause::kMirror:
      return "mirror";
    case Cause::kDoubleBounce:
      return "double_bounce";
    case Cause::kFalseAlarm:
      return "false_alarm";
  }
  return "";
}

/// The truth about one detection.
struct Label {
  Cause cause = Cause::kFalseAlarm;
  int reflector = -1;  ///< index in the room, -1 for a false alarm
};

/// A scan and the label of each of its detections.
struct LabeledScan {
  RadarScan scan;
  std::vector<Label> labels;
};

/// `value` folded into [-limit, limit).
inline double fold(double value, double limit) {
  const double folded = value - 2.0 * limit * std::floor((value + limit) / (2.0 * limit));
  return folded < limit ? folded : -limit;
}

/// Range [m], azimuth [rad], elevation [rad]; inverse of (E1).
struct Polar {
  double range = 0.0;
  double azimuth = 0.0;
  double elevation = 0.0;

  static Polar of(const Vector3d& point_S) {
    return {point_S.norm(), std::atan2(point_S.y(), point_S.x()),
            std::atan2(point_S.z(), point_S.head<2>().norm())};
  }
  Vector3d point() const {  // (E1)
    const double level = range * std::cos(elevation);
    return {level * std::cos(azimuth), level * std::sin(azimuth), range * std::sin(elevation)};
  }
};

}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the simulated radar, its truth labels, polar coordinates, Doppler folding and the
// grid of an angle FFT.
//
// (E1) point = r (cos el cos az, cos el sin az, sin el) in S
// (E2) the angle FFT reports y/r and z/r in steps of g; x/r = sqrt(1 - (y/r)^2 - (z/r)^2)
#pragma once

#include <cstdint>
#include <vector>

#include "rio/types.hpp"

namespace rio::sim {

using rio::kDegree;

/// Mounted at the front and pitched down by an angle [rad].
Pose default_radar_mount(double pitch = 45.0 * kDegree);

/// Mounting of several radars on one body, given the first: two look ahead and straight down, three
/// or four evenly around the vertical.
std::vector<Pose> radar_mounts(const Pose& first, std::size_t count);

/// The simulated radar. Defaults: AWR1843-like, indoor chirp.
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
  double fresh_noise = 0.05;                ///< part of the sigmas that is new in every scan
  /// E-folding distance of the rest of the noise [m]: at rest scans repeat, in flight hardly.
  /// Echoes that share a cell of width w at range r change their relative phase by half a turn when
  /// the radar moves by about half a wavelength times r / w: 1 to 2 cm at 77 GHz and 15 deg.
  double noise_distance = 0.02;
  double angle_grid = 1.0 / 32.0;    ///< of the direction cosines y/r and z/r; 0 = none
  double weak_angle_growth = 1.0;    ///< angle variance at the threshold: times 1 + this
  double snr_1m_db = 53.0;           ///< of 0 dBsm at 1 m on boresight [dB]
  double edge_loss_db = 6.0;         ///< two-way antenna loss at the edge of the view [dB]
  double threshold_db = 10.0;        ///< detection threshold [dB]
  double fading_sigma_db = 5.0;      ///< interference, changes as the radar moves [dB]
  double fading_distance = 0.15;     ///< e-folding distance of fading and wander [m]
  double flicker_sigma_db = 0.7;     ///< changes with every scan [dB]
  double wander_sigma = 0.01;        ///< scattering centre about its mean, per axis [m]
  double outlier_share = 0.15;       ///< of all detections: ghosts and false alarms
  double false_alarm_share = 0.4;    ///< of the outliers; the others are ghosts
  int max_static = 34;               ///< static detections kept, the strongest
  bool specular = true;              ///< highlights on walls and edges that move along
  int people = 0;                    ///< walking people, each a cloud of scatterers
  double person_rcs_dbsm = -12.0;    ///< mean of a scatterer of a person [dB(m^2)]
  double burst_outlier_share = 0.8;  ///< of all detections during a burst
  int own_echoes = 0;            ///< visible points on the vehicle: static relative to the radar
  double own_echo_share = 0.25;  ///< share of the scans in which each of them is detected
  /// Share of misreadings at the border of two Doppler cells: the detection gets the wrong cell.
  /// Falls to zero at the centre of a cell.
  double doppler_slip_share = 0.0;
  double lobe_width = 0.0;      ///< aspect at which a reflector is 3 dB down; 0 = none [rad]
  double lost_share = 0.0;      ///< share of scans lost on the way to the host
  double doppler_scale = 0.0;   ///< relative error of the reported range rates
  double elevation_bias = 0.0;  ///< added to every elevation [rad]
  /// Error of azimuth and elevation that all points share, by what lasts in a scene: multipath of
  /// floor and walls, the sides from which things are seen [rad].
  double scene_angle = 0.0;
  double scene_distance = 3.0;  ///< e-folding distance of that [m]
  double stamp_offset = 0.0;    ///< the stamps are late by this [s]
  double latency = 0.0;         ///< from the measurement to the arrival of a scan [s]

  /// The Doppler limit that the radar reports, as wrong as its range rates; 0 = none [m/s].
  double reported_max_doppler() const {
    return ambiguous ? (1.0 + doppler_scale) * max_doppler : 0.0;
  }
  double reported_doppler_resolution() const {
    return quantize ? (1.0 + doppler_scale) * doppler_resolution : 0.0;
  }

  /// Only what a filter models: unbiased Gaussian noise on the polar coordinates and the Doppler.
  static RadarModel ideal();
};

/// Cause of a detection.
enum class Cause : std::uint8_t {
  kStatic,        ///< a reflector, seen directly
  kMirror,        ///< its image behind a wall, below the floor or above the ceiling
  kDoubleBounce,  ///< twice to it and back: twice the range and the range rate
  kSpecular,  ///< highlight of a wall or an edge: moves along with the radar, the surface is static
  kPerson,    ///< a walking person
  kFalseAlarm,  ///< none: random position and Doppler
  kVehicle,     ///< the vehicle that carries the radar: always without Doppler
};

/// Name as in the label file.
const char* to_string(Cause cause);

/// The truth about one detection.
struct Label {
  Cause cause = Cause::kFalseAlarm;
  int reflector = -1;  ///< index in the room, wall or edge, or person; -1 for a false alarm
};

/// A scan and the label of each of its detections.
struct LabeledScan {
  RadarScan scan;
  std::vector<Label> labels;
};

/// `value` folded into [-limit, limit).
double fold(double value, double limit);

/// Range [m], azimuth [rad], elevation [rad]; inverse of (E1).
struct Polar {
  double range = 0.0;
  double azimuth = 0.0;
  double elevation = 0.0;

  static Polar of(const Vector3d& point_S);
  Vector3d point() const;
};

/// (E2): the point on the grid of direction cosines, its range unchanged. A grid point outside the
/// unit circle is not a direction; the larger cosine is then reduced.
Vector3d snap_direction(const Vector3d& point_S, double grid);

}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
// The mean of everything estimated, shared by both back-ends and read by the front-end.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "rio/core/static_vector.hpp"
#include "rio/options.hpp"
#include "rio/propagate/steady_motion.hpp"
#include "rio/state/auxiliary.hpp"
#include "rio/state/blocks.hpp"
#include "rio/types.hpp"

namespace rio {

/// Upper bounds of the options max_clones, max_landmarks and max_detections.
inline constexpr std::size_t kMaxClones = 20;
inline constexpr std::size_t kMaxLandmarks = 64;
inline constexpr std::size_t kMaxDetections = 1024;

/// Eigen aligns the state by -march and EIGEN_MAX_ALIGN_BYTES: with those of another build of the
/// library it has other layouts, and the program does not link.
template <int kBytes>
void is_aligned_as_in_the_library();
[[gnu::used]] static void (*const kAlignedAsTheLibrary)() =
    &is_aligned_as_in_the_library<EIGEN_MAX_STATIC_ALIGN_BYTES>;

/// Radars on one body.
inline constexpr std::size_t kMaxRadars = 1 + Options::kMaxOtherRadars;

/// Scans are numbered in the order they are processed; scans of several radars that are processed
/// at the same instant share the number, as they share the pose.
using ScanId = std::uint64_t;
/// The ScanId of a state without a scan.
inline constexpr ScanId kNoScan = std::numeric_limits<ScanId>::max();

/// The body pose at a past radar scan (stochastic cloning).
struct Clone {
  ScanId scan = 0;
  RigidPose T_WB;
  std::array<bool, kMaxRadars> kept_for{};  ///< by radar: one of its last scans was taken here
};

/// Past poses that are kept for each radar, of all radars together kMaxClones at most.
inline std::size_t clones_per_radar(const Options& options) {
  return std::min(static_cast<std::size_t>(options.update.max_clones),
                  kMaxClones / options.radars());
}

/// A persistent landmark.
struct LandmarkState {
  Vector3d p_W = Vector3d::Zero();  ///< [m]
  Time last_seen = Time(0);         ///< scan of the last match that was used
  /// For matching: predicted covariance of its position relative to the radar, S axes [m^2].
  Matrix3d covariance_S = Matrix3d::Zero();
  /// Innovations of its direction, summed over its looks (update/look_correlation.hpp).
  struct Looks {
    Eigen::Vector2d innovation = Eigen::Vector2d::Zero();
    Eigen::Vector2d squares = Eigen::Vector2d::Zero();
    double elevation_walk = 0.0;  ///< variance its elevation gains on the way [rad^2/m]
  };
  double distance_seen = 0.0;  ///< distance the body had travelled at its last measurement [m]
  double distance_born = 0.0;  ///< same, at its first measurement [m]
  Looks looks{};
  bool retired = false;  ///< missed: no longer matched, kept for states that have measured it
};

/// What is estimated of one radar.
struct RadarState {
  Pose T_BS;
  double doppler_scale = 0.0;    ///< relative error of the range rates as received
  double time_offset = 0.0;      ///< stamp minus time of measurement [s]
  double elevation_error = 0.0;  ///< of landmarks (state/blocks.hpp); 0 but in a window [rad]
};

/// Predicted or corrected means at one instant. The RadarState is that of the radar whose scan is
/// being processed.
struct Estimate : RadarState {
  NavState nav;
  Vector3d gyro_B = Vector3d::Zero();  ///< measured angular rate at nav.time, bias included [rad/s]
  double gyro_variance = 0.0;          ///< of that measurement, per axis [rad^2/s^2]
  double accel_density = 0.0;          ///< of the accelerometer, measured [(m/s^2)^2/Hz]
  SteadyMotion steady;                 ///< where the Jacobians of the calibration are evaluated
  double distance_travelled = 0.0;     ///< since the start [m]
  std::size_t radar = 0;               ///< whose scan is being processed
  std::array<RadarState, kMaxRadars> others;            ///< by radar; the entry of `radar` is stale
  AuxiliaryValues auxiliary = AuxiliaryValues::Zero();  ///< states of extensions
  StaticVector<Clone, kMaxClones> clones;  ///< of each radar the newest replaces the oldest
  StaticVector<LandmarkState, kMaxLandmarks> landmarks;

  const RadarState& of_radar(std::size_t r) const { return r == radar ? *this : others[r]; }
  void set_radar(std::size_t r, const RadarState& state) {
    (r == radar ? *this : others[r]) = state;
  }
  /// Makes radar r the one whose scan is being processed.
  void select_radar(std::size_t r) {
    others[radar] = *this;
    radar = r;
    set_radar(r, others[r]);
  }

  /// Body pose as matrices.
  RigidPose T_WB() const { return RigidPose(Pose{nav.q_WB, nav.p_WB}); }
  /// Index of the clone of `scan`, or -1 if it has left the window.
  int find_clone(ScanId scan) const;
};

/// Adds an error in the order of namespace body.
void add_error(const Eigen::Matrix<double, body::kSize, 1>& error, NavState* nav);

/// Radar point in world coordinates: the inverse observation model (ICRA 2023, eq. 12).
Vector3d to_world(const RigidPose& T_WB, const RigidPose& T_BS, const Vector3d& point_S);
/// World point in radar coordinates (ICRA 2023, eq. 13).
Vector3d to_radar(const RigidPose& T_WB, const RigidPose& T_BS, const Vector3d& point_W);
/// Velocity of the radar in its own axes [m/s] for a true angular rate of the body [rad/s].
Vector3d radar_velocity(const RigidPose& T_WB, const Vector3d& v_WB, const Vector3d& rate_B,
                        const RigidPose& T_BS);
Vector3d radar_velocity(const Estimate& x);

}  // namespace rio

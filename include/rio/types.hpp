// SPDX-License-Identifier: BSD-3-Clause
// The data types of the data flow: plain structs, a unit and a frame on every field. C++17.
//
// Frames: W world (z up), B body = IMU (x forward, y left, z up), S radar (x boresight, y left, z
// up). R_AB maps coordinates in B to coordinates in A; p_AB is the position of B in A; the suffix
// of a free vector names its axes (gyro_B).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <chrono>
#include <vector>

namespace rio {

/// Nanoseconds since an epoch common to all sensors; also used for differences of instants.
using Time = std::chrono::nanoseconds;

/// Seconds of a duration (loses nanoseconds when applied to an instant: use it on differences).
inline double to_seconds(Time duration) {
  return std::chrono::duration<double>(duration).count();
}
/// The duration nearest to `seconds`; exact to the nanosecond for |seconds| < 4e6.
inline Time from_seconds(double seconds) {
  return Time(static_cast<Time::rep>(seconds * 1e9 + (seconds < 0.0 ? -0.5 : 0.5)));
}

using Vector3d = Eigen::Vector3d;
using Matrix3d = Eigen::Matrix3d;
/// Hamilton unit quaternion whose size and alignment do not depend on compiler flags.
using Quaternion = Eigen::Quaternion<double, Eigen::DontAlign>;

inline constexpr double kDegree = 3.14159265358979323846 / 180.0;  ///< [rad]
inline constexpr double kStandardGravity = 9.80665;                ///< the unit g [m/s^2]

/// One inertial measurement.
struct ImuSample {
  Time time{0};
  Vector3d gyro_B = Vector3d::Zero();   ///< angular rate [rad/s]
  Vector3d accel_B = Vector3d::Zero();  ///< specific force [m/s^2], +g upwards at rest
};

/// One radar detection.
struct RadarDetection {
  Vector3d point_S = Vector3d::Zero();  ///< position in the radar frame [m]
  double range_rate = 0.0;              ///< Doppler [m/s], positive = receding
  double snr_db = 0.0;                  ///< signal to noise ratio [dB]
  double noise_db = 0.0;                ///< noise floor [dB], 0 = unknown
  double sigma_range = 0.0;             ///< [m]; here and below, 0 = unknown: the options are used
  double sigma_azimuth = 0.0;           ///< [rad]
  double sigma_elevation = 0.0;         ///< [rad]
  double sigma_doppler = 0.0;           ///< [m/s]
};

/// All detections of one radar frame; `time` is the middle of the chirp block. May be empty.
struct RadarScan {
  Time time{0};
  std::vector<RadarDetection> detections;
};

/// Pose of one frame in another; as T_BS: p_B = rotation * p_S + translation.
struct Pose {
  Quaternion rotation = Quaternion::Identity();
  Vector3d translation = Vector3d::Zero();  ///< [m]
};

/// Navigation state of the body at one instant.
struct NavState {
  Time time{0};
  Quaternion q_WB = Quaternion::Identity();  ///< attitude, maps B to W
  Vector3d p_WB = Vector3d::Zero();          ///< position [m]
  Vector3d v_WB = Vector3d::Zero();          ///< velocity in W axes [m/s]
  Vector3d gyro_bias = Vector3d::Zero();     ///< measured less true, in B axes [rad/s]
  Vector3d accel_bias = Vector3d::Zero();    ///< the same [m/s^2]
};

/// Error order of the body state: R = R^ Exp(dphi), all else true = estimate + error.
namespace body {
inline constexpr int kAttitude = 0;    ///< dphi, local (right), body axes [rad]
inline constexpr int kPosition = 3;    ///< dp [m]
inline constexpr int kVelocity = 6;    ///< dv [m/s]
inline constexpr int kGyroBias = 9;    ///< dbg [rad/s]
inline constexpr int kAccelBias = 12;  ///< dba [m/s^2]
inline constexpr int kSize = 15;
}  // namespace body

/// Covariance of the body error state, order of namespace body.
using BodyCovariance = Eigen::Matrix<double, body::kSize, body::kSize, Eigen::DontAlign>;

}  // namespace rio

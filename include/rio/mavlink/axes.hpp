// SPDX-License-Identifier: BSD-3-Clause
// Conversion between the axes of this library (z up) and of autopilots (z down): vectors,
// attitudes, covariances. C++17.
//
//   body    FLU x forward, y left, z up      <-> FRD x forward, y right, z down
//   local   FLU x anywhere level, z up       <-> FRD x the same, z down (MAV_FRAME_LOCAL_FRD)
//   earth   ENU x east, y north, z up        <-> NED x north, y east, z down
//
// Both changes of axes are half turns, D = diag(1, -1, -1) about x and T about the bisector of x
// and y, hence their own inverses: the two named functions of a pair are identical.
//
// The world W of an estimator without a compass is a local FLU: MAV_FRAME_LOCAL_FRD is its frame.
// It is ENU only if the start had a known heading (x = east).
#pragma once

#include <Eigen/Core>

#include "rio/mavlink/messages.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

/// Covariance of two vectors, as position and rotation, or velocity and angular rate.
using Matrix6d = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;

/// A vector, body or local: D v.
inline Vector3d flu_to_frd(const Vector3d& v) {
  return {v.x(), -v.y(), -v.z()};
}
inline Vector3d frd_to_flu(const Vector3d& v) {
  return flu_to_frd(v);
}

/// A vector in earth axes: T v.
inline Vector3d enu_to_ned(const Vector3d& v) {
  return {v.y(), v.x(), -v.z()};
}
inline Vector3d ned_to_enu(const Vector3d& v) {
  return enu_to_ned(v);
}

/// Attitude of a FLU body in a local FLU frame -> of the FRD body in the local FRD frame: D R D.
Quaternion attitude_flu_to_frd(const Quaternion& q);
inline Quaternion attitude_frd_to_flu(const Quaternion& q) {
  return attitude_flu_to_frd(q);
}

/// Attitude of a FLU body in ENU -> of the FRD body in NED: T R D.
Quaternion attitude_enu_to_ned(const Quaternion& q);
/// Attitude of a FRD body in NED -> of the FLU body in ENU: T R D.
inline Quaternion attitude_ned_to_enu(const Quaternion& q) {
  return attitude_enu_to_ned(q);
}

/// Covariance of two vectors in axes FLU (position and rotation about the local axes, or velocity
/// and angular rate in body axes) -> in axes FRD: C with diag(D, D) on both sides.
Matrix6d covariance_flu_to_frd(const Matrix6d& c);
inline Matrix6d covariance_frd_to_flu(const Matrix6d& c) {
  return covariance_flu_to_frd(c);
}

/// Same for earth axes: C with diag(T, T) on both sides.
Matrix6d covariance_enu_to_ned(const Matrix6d& c);
inline Matrix6d covariance_ned_to_enu(const Matrix6d& c) {
  return covariance_enu_to_ned(c);
}

/// Covariance of [p_WB, rotation about the axes of W], 6x6, W axes [m, rad]: the local error dphi
/// of the attitude is R_WB dphi about the world axes (to first order).
Matrix6d pose_covariance(const Quaternion& q_WB, const BodyCovariance& P);

/// Covariance of [v_B, angular rate], 6x6, body axes [m/s, rad/s]. With v_B = R_WB' v_WB
///   dv_B = R_WB' dv + [v_B] dphi,   domega = -dbg - noise,
/// correlations included.
/// @param gyro_sigma noise of the gyro sample used for the rate [rad/s]
Matrix6d twist_covariance(const NavState& state, const BodyCovariance& P, double gyro_sigma);

/// The upper triangle, row by row, as in MAVLink.
UpperTriangle upper_triangle(const Matrix6d& c);
/// The symmetric matrix of an upper triangle.
Matrix6d from_upper_triangle(const UpperTriangle& triangle);

}  // namespace rio::mavlink

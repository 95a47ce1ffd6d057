// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/landmark_birth.hpp"

#include "rio/core/so3.hpp"

namespace rio {

LandmarkBirth::LandmarkBirth(const RigidPose& T_WB, const RigidPose& T_BS, double elevation_error,
                             const Detection& d) {
  const Vector3d raised_S = d.range * d.sigma_elevation_S.normalized();
  const Vector3d point_S = d.point_S - elevation_error * raised_S;
  p_WL = to_world(T_WB, T_BS, point_S);
  const Matrix3d R_WS = T_WB.R * T_BS.R;
  d_l.setZero();
  Vector3d point_B = T_BS.R * point_S;
  point_B += T_BS.p;
  const Matrix3d covariance_S = point_covariance(d);
  const Matrix3d half_turned = R_WS * covariance_S;
  d_l.middleCols<3>(Blocks::column<BodyPose>()) = T_WB.R * skew(-point_B);
  d_l.middleCols<3>(Blocks::column<BodyPose>() + 3).setIdentity();
  d_l.middleCols<3>(Blocks::column<Extrinsics>()) = R_WS * skew(-point_S);
  d_l.middleCols<3>(Blocks::column<Extrinsics>() + 3) = T_WB.R;
  d_l.col(Blocks::column<ElevationError>()) = -R_WS * raised_S;
  noise = half_turned * R_WS.transpose();
}

ObservedPoint::ObservedPoint(const RigidPose& T_WB, const RigidPose& T_BS, const Vector3d& p_WL) {
  const Vector3d from_body_W = p_WL - T_WB.p;
  const Vector3d from_body = T_WB.R.transpose() * from_body_W;
  const Vector3d from_radar = from_body - T_BS.p;
  const Matrix3d R_SB = T_BS.R.transpose();
  const Matrix3d R_SW = R_SB * T_WB.R.transpose();
  e_S = R_SB * from_radar;
  const Matrix3d by_attitude = R_SB * skew(from_body);
  d_e << by_attitude, -R_SW, skew(e_S), -R_SB, R_SW;
}

}  // namespace rio

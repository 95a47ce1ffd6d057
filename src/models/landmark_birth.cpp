// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/landmark_birth.hpp"

namespace rio {

LandmarkBirth::LandmarkBirth(const RigidPose& T_WB, const RigidPose& T_BS, const Detection& d)
    : p_WL(to_world(T_WB, T_BS, d.point_S)) {
  const Matrix3d R_WS = T_WB.R * T_BS.R;
  const Vector3d upwards = d.range * d.sigma_elevation_S.normalized();
  d_l.setZero();
  d_l.middleCols<3>(Blocks::column<BodyPose>()) = -T_WB.R * skew(T_BS.R * d.point_S + T_BS.p);
  d_l.middleCols<3>(Blocks::column<BodyPose>() + 3).setIdentity();
  d_l.middleCols<3>(Blocks::column<Extrinsics>()) = -R_WS * skew(d.point_S);
  d_l.middleCols<3>(Blocks::column<Extrinsics>() + 3) = T_WB.R;
  d_l.col(Blocks::column<RadarErrors>() + RadarErrors::kElevation) = -R_WS * upwards;
  noise = R_WS * point_covariance(d) * R_WS.transpose();
}

ObservedPoint::ObservedPoint(const RigidPose& T_WB, const RigidPose& T_BS, const Vector3d& p_WL) {
  const Vector3d from_body = T_WB.R.transpose() * (p_WL - T_WB.p);
  const Matrix3d R_SW = (T_WB.R * T_BS.R).transpose();
  e_S = T_BS.R.transpose() * (from_body - T_BS.p);
  d_e << T_BS.R.transpose() * skew(from_body), -R_SW, skew(e_S), -T_BS.R.transpose(), R_SW;
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/trail_distance.hpp"

namespace rio {

bool TrailDistanceModel::evaluate(const Measurement& z, const RigidPose& T_WB,
                                  const RigidPose& clone_T_WB, const RigidPose& T_BS,
                                  ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                                  JacobianOf<kDim, kDim>& R) const noexcept {
  Vector3d q = T_BS.R * z.past_S;
  q += T_BS.p;
  Vector3d from_body_W = clone_T_WB.R * q;
  from_body_W += clone_T_WB.p - T_WB.p;
  const Vector3d from_body = T_WB.R.transpose() * from_body_W;
  const Vector3d from_radar = from_body - T_BS.p;
  const double h = from_radar.norm();
  if (!(h > kMinRange)) return false;
  const Vector3d a = from_radar / h;
  const Vector3d a_W = T_WB.R * a;
  const Vector3d a_clone = clone_T_WB.R.transpose() * a_W;
  const Vector3d a_S = T_BS.R.transpose() * a_clone;
  r[0] = z.range - h;  // (E1)
  R(0, 0) = sigma_distance_ * sigma_distance_;
  if (J == nullptr) return true;

  J->block<1, 3>(0, Blocks::column<BodyPose>()) = a.cross(from_body).transpose();
  J->block<1, 3>(0, Blocks::column<BodyPose>() + 3) = -a_W.transpose();
  J->block<1, 3>(0, Blocks::column<ClonePose>()) = q.cross(a_clone).transpose();
  J->block<1, 3>(0, Blocks::column<ClonePose>() + 3) = a_W.transpose();
  J->block<1, 3>(0, Blocks::column<Extrinsics>()) = z.past_S.cross(a_S).transpose();
  J->block<1, 3>(0, Blocks::column<Extrinsics>() + 3) = (a_clone - a).transpose();
  return true;
}

}  // namespace rio

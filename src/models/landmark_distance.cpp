// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/landmark_distance.hpp"

namespace rio {

bool LandmarkDistanceModel::evaluate(const Measurement& z, const RigidPose& T_WB,
                                     const RigidPose& T_BS, const Vector3d& p_WL,
                                     ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                                     JacobianOf<kDim, kDim>& R) const noexcept {
  const Vector3d from_body_W = p_WL - T_WB.p;
  const Vector3d from_body = T_WB.R.transpose() * from_body_W;
  const Vector3d from_radar = from_body - T_BS.p;
  const double h = from_radar.norm();
  if (!(h > kMinRange)) return false;
  r[0] = z.range - h;  // (E1)
  R(0, 0) = sigma_distance_ * sigma_distance_;
  if (J == nullptr) return true;

  const Vector3d a = from_radar / h;
  const Vector3d a_W = T_WB.R * a;
  J->block<1, 3>(0, Blocks::column<BodyPose>()) = a.cross(from_body).transpose();
  J->block<1, 3>(0, Blocks::column<BodyPose>() + 3) = -a_W.transpose();
  J->block<1, 3>(0, Blocks::column<Extrinsics>()).setZero();  // a range does not depend on it
  J->block<1, 3>(0, Blocks::column<Extrinsics>() + 3) = -a.transpose();
  J->block<1, 3>(0, Blocks::column<Landmark>()) = a_W.transpose();
  return true;
}

}  // namespace rio

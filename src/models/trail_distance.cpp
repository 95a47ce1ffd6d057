// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/trail_distance.hpp"

namespace rio {

bool TrailDistanceModel::evaluate(const Measurement& z, const RigidPose& T_WB,
                                  const RigidPose& clone_T_WB, const RigidPose& T_BS,
                                  ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                                  JacobianOf<kDim, kDim>& R) const noexcept {
  const Vector3d q = T_BS.R * z.past_S + T_BS.p;
  const Vector3d from_body = T_WB.R.transpose() * (clone_T_WB.R * q + clone_T_WB.p - T_WB.p);
  const Vector3d e = T_BS.R.transpose() * (from_body - T_BS.p);
  const double h = e.norm();
  if (!(h > kMinRange)) return false;
  const Vector3d u = e / h;
  const Vector3d a = T_BS.R * u;
  const Eigen::RowVector3d a_W = (T_WB.R * a).transpose();
  const Eigen::RowVector3d a_clone = a_W * clone_T_WB.R;
  r[0] = z.range - h;  // (E1)
  R(0, 0) = sigma_distance_ * sigma_distance_;
  if (J == nullptr) return true;

  J->block<1, 3>(0, Blocks::column<BodyPose>()) = a.transpose() * skew(from_body);
  J->block<1, 3>(0, Blocks::column<BodyPose>() + 3) = -a_W;
  J->block<1, 3>(0, Blocks::column<ClonePose>()) = -a_clone * skew(q);
  J->block<1, 3>(0, Blocks::column<ClonePose>() + 3) = a_W;
  J->block<1, 3>(0, Blocks::column<Extrinsics>()) = -a_clone * T_BS.R * skew(z.past_S);
  J->block<1, 3>(0, Blocks::column<Extrinsics>() + 3) = a_clone - a.transpose();
  return true;
}

}  // namespace rio

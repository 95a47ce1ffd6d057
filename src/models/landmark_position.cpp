// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/landmark_position.hpp"

namespace rio {

bool LandmarkPositionModel::evaluate(const Measurement& z, const RigidPose& T_WB,
                                     const RigidPose& T_BS, const Vector3d& p_WL,
                                     ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                                     JacobianOf<kDim, kDim>& R) const noexcept {
  const ObservedPoint point(T_WB, T_BS, p_WL);
  r = z.point_S - point.e_S;  // (E1)
  R = z.covariance;
  if (J == nullptr) return true;

  J->block<3, 6>(0, Blocks::column<BodyPose>()) = point.d_body();
  J->block<3, 6>(0, Blocks::column<Extrinsics>()) = point.d_extrinsics();
  J->block<3, 3>(0, Blocks::column<Landmark>()) = point.d_landmark();
  return true;
}

}  // namespace rio

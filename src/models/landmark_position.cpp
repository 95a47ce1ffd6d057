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
  if (J != nullptr) *J = point.d_e;
  return true;
}

}  // namespace rio

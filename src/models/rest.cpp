// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/rest.hpp"

#include "rio/core/so3.hpp"

namespace rio {

bool RestModel::evaluate(const Measurement& z, const RigidPose& T_WB, const Vector3d& v_WB,
                         const Vector3d& gyro_bias, ResidualOf<kDim>& r,
                         JacobianOf<kDim, Blocks::kDof>* J,
                         JacobianOf<kDim, kDim>& R) const noexcept {
  const Vector3d v_B = T_WB.R.transpose() * v_WB;
  r << -v_B, z.gyro_B - gyro_bias;  // (E1) (E2)
  R.setZero();
  R.diagonal().head<3>().setConstant(z.sigma_velocity * z.sigma_velocity);
  R.diagonal().tail<3>().setConstant(z.sigma_rate * z.sigma_rate);
  if (J == nullptr) return true;
  J->setZero();
  J->block<3, 3>(0, Blocks::column<BodyPose>()) = skew(v_B);
  J->block<3, 3>(0, Blocks::column<BodyVelocity>()) = T_WB.R.transpose();
  J->block<3, 3>(3, Blocks::column<GyroBias>()).setIdentity();
  return true;
}

}  // namespace rio

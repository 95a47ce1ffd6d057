// SPDX-License-Identifier: BSD-3-Clause
#include "rio/state/estimate.hpp"

#include "rio/core/so3.hpp"

namespace rio {

template <int kBytes>
void is_aligned_as_in_the_library() {}
template void is_aligned_as_in_the_library<EIGEN_MAX_STATIC_ALIGN_BYTES>();

int Estimate::find_clone(ScanId scan) const {
  for (std::size_t i = 0; i < clones.size(); ++i) {
    if (clones[i].scan == scan) return static_cast<int>(i);
  }
  return -1;
}

void add_error(const Eigen::Matrix<double, body::kSize, 1>& error, NavState* nav) {
  nav->q_WB = (nav->q_WB * quaternion_exp(error.segment<3>(body::kAttitude))).normalized();
  nav->p_WB += error.segment<3>(body::kPosition);
  nav->v_WB += error.segment<3>(body::kVelocity);
  nav->gyro_bias += error.segment<3>(body::kGyroBias);
  nav->accel_bias += error.segment<3>(body::kAccelBias);
}

Vector3d to_world(const RigidPose& T_WB, const RigidPose& T_BS, const Vector3d& point_S) {
  Vector3d point_B = T_BS.R * point_S;
  point_B += T_BS.p;
  Vector3d point_W = T_WB.R * point_B;
  point_W += T_WB.p;
  return point_W;
}

Vector3d to_radar(const RigidPose& T_WB, const RigidPose& T_BS, const Vector3d& point_W) {
  const Vector3d from_body_W = point_W - T_WB.p;
  Vector3d point_B = T_WB.R.transpose() * from_body_W;
  point_B -= T_BS.p;
  return T_BS.R.transpose() * point_B;
}

Vector3d radar_velocity(const RigidPose& T_WB, const Vector3d& v_WB, const Vector3d& rate_B,
                        const RigidPose& T_BS) {
  Vector3d v_B = T_WB.R.transpose() * v_WB;
  v_B += rate_B.cross(T_BS.p);
  return T_BS.R.transpose() * v_B;
}

Vector3d radar_velocity(const Estimate& x) {
  return radar_velocity(x.T_WB(), x.nav.v_WB, x.gyro_B - x.nav.gyro_bias, RigidPose(x.T_BS));
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/linearize.hpp"

#include "rio/core/so3.hpp"

namespace rio {

LinearizationPoint::LinearizationPoint(const Estimate& x)
    : LinearizationPoint(x, x.nav, x.gyro_B, x.steady) {}

LinearizationPoint::LinearizationPoint(const Estimate& x, const NavState& nav,
                                       const Vector3d& measured_gyro_B,
                                       const SteadyMotion& steady_motion)
    : estimate(x),
      T_WB(nav.q_WB.toRotationMatrix(), nav.p_WB),
      T_BS(x.T_BS),
      v_WB(nav.v_WB),
      gyro_bias(nav.gyro_bias),
      gyro_B(measured_gyro_B),
      accel_W(steady_motion.accel_W),
      steady(steady_motion),
      elevation_error(x.elevation_error) {
  pose_rate << gyro_B - gyro_bias, v_WB;
}

void LinearizationPoint::step_back(double seconds) {
  const Vector3d turn = seconds * pose_rate.head<3>();
  step = {seconds, gamma(0, turn), seconds * gamma(1, turn), seconds * skew(accel_W) * T_WB.R};
  T_WB = PoseBlock::retract(T_WB, -seconds * pose_rate);
  v_WB -= seconds * accel_W;
}

SteadyOffset LinearizationPoint::steady_offset() const {
  const Vector3d radar_v_B = steady.v_B + steady.rate_B.cross(T_BS.p);
  return {T_BS.R.transpose() * radar_v_B - radar_velocity_S(),
          steady.rate_B - (gyro_B - gyro_bias)};
}

}  // namespace rio

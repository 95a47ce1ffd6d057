// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/aiding.hpp"

#include "rio/core/so3.hpp"

namespace rio {

AidedState aided_state(const AidingMeasurement& z, const ImuIncrements& since, const NavState& nav,
                       const Estimate& x, double gravity) {
  const double s = since.seconds;
  const Vector3d g_W(0.0, 0.0, -gravity);
  const RadarState& radar = x.of_radar(z.radar());
  AidedState then;
  then.T_WB.R = nav.q_WB.toRotationMatrix() * since.turn.transpose();
  then.v_WB = nav.v_WB - s * g_W - then.T_WB.R * since.velocity;
  then.T_WB.p = nav.p_WB - s * then.v_WB - 0.5 * s * s * g_W - then.T_WB.R * since.position;
  then.gyro_bias = nav.gyro_bias;
  then.T_BS = RigidPose(radar.T_BS);
  then.doppler_scale = radar.doppler_scale;
  return then;
}

bool linearize(const AidingMeasurement& z, const ImuIncrements& since, const NavState& nav,
               const Estimate& x, const AuxiliaryStates& states, double gravity,
               const AidingColumns& columns, AidingRows* rows) {
  const double s = since.seconds;
  AidedState then = aided_state(z, since, nav, x, gravity);
  then.states = &states;
  then.auxiliary = &x.auxiliary;
  AidingMeasurement::Rows at_its_time;
  if (!z.evaluate(then, columns, &at_its_time)) return false;
  const Vector3d turn = quaternion_log(Quaternion(since.turn));
  const Matrix3d by_bias = s * gamma(1, turn);
  const Matrix3d v_by_phi = then.T_WB.R * skew(since.velocity);
  const Matrix3d p_by_phi = then.T_WB.R * skew(since.position);
  rows->clear();
  for (int i = 0; i < at_its_time.count; ++i) {
    const Eigen::Matrix<double, AidingMeasurement::kColumns, 1> J =
        at_its_time.J.row(i).transpose();
    const Vector3d p = J.segment<3>(body::kPosition);
    const Vector3d v = J.segment<3>(body::kVelocity) - s * p;
    const Vector3d by_u = v_by_phi.transpose() * v;
    const Vector3d by_w = p_by_phi.transpose() * p;
    const Vector3d phi = J.segment<3>(body::kAttitude) + by_u + by_w;
    const Vector3d bias =
        J.segment<3>(body::kGyroBias) + by_bias.transpose() * phi - s * (by_u / 2.0 + by_w / 3.0);
    LinearRow row;
    row.residual = at_its_time.r[i];
    row.variance = 1.0;
    row.segments[0] = {columns.body, AidingMeasurement::kBody};
    row.segment_count = 1;
    Eigen::Map<Eigen::Matrix<double, AidingMeasurement::kColumns, 1>> h(row.h.data());
    h = J;
    h.segment<3>(body::kAttitude) = Vector3d(since.turn.transpose() * phi);
    h.segment<3>(body::kVelocity) = v;
    h.segment<3>(body::kGyroBias) = bias;
    for (const auto& [column, length] : at_its_time.segments) {
      row.segments[row.segment_count++] = {column, length};
    }
    rows->push_back(row);
  }
  return true;
}

}  // namespace rio

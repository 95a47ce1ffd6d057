// SPDX-License-Identifier: BSD-3-Clause
// What the tests of preintegration and of its factor share.
#pragma once

#include "rio/smoother/preintegration.hpp"
#include "support/strapdown_case.hpp"

namespace rio::test {

// At rest but for rounding, as flown, and beyond any gyro's range [rad/s].
inline constexpr double kRates[] = {1e-9, 1.5, 30.0};

inline double seconds(const ImuStep& step) {
  return to_seconds(step.end - step.begin);
}

inline Preintegration preintegrate(const Steps& steps, const Vector3d& gyro_bias,
                                   const Vector3d& accel_bias, const ImuOptions& options = {}) {
  Preintegration out;
  out.reset(gyro_bias, accel_bias);
  for (const ImuStep& step : steps) out.step(step, options);
  return out;
}

// The state after the last step, starting `from` the state at the first, with its biases.
inline NavState predict(const Preintegration& imu, const NavState& from, double gravity) {
  const ImuIncrement d = imu.corrected(from.gyro_bias, from.accel_bias);
  const double T = to_seconds(imu.duration());
  const Matrix3d R = from.q_WB.toRotationMatrix();
  const Vector3d g(0.0, 0.0, -gravity);
  NavState out = from;
  out.time += imu.duration();
  out.q_WB = (from.q_WB * d.delta_q).normalized();
  out.p_WB += R * d.delta_p + (from.v_WB + 0.5 * T * g) * T;
  out.v_WB += R * d.delta_v + g * T;
  return out;
}

// From the increment of body i to the navigation error in W.
inline Matrix15d to_world(const Quaternion& q_WB) {
  Matrix15d M = Matrix15d::Identity();
  M.block<3, 3>(body::kPosition, body::kPosition) = q_WB.toRotationMatrix();
  M.block<3, 3>(body::kVelocity, body::kVelocity) = q_WB.toRotationMatrix();
  return M;
}

}  // namespace rio::test

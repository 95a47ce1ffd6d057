// SPDX-License-Identifier: BSD-3-Clause
#include "support/random_state.hpp"

namespace rio::test {

Vector3d Random::normal_vector(double sigma) {
  const double x = normal(sigma);
  const double y = normal(sigma);
  return {x, y, normal(sigma)};
}

Vector3d Random::direction() {
  return normal_vector().normalized();
}

Quaternion Random::rotation() {
  const double w = normal();
  const Vector3d v = normal_vector();
  return Quaternion(w, v.x(), v.y(), v.z()).normalized();
}

NavState Random::state() {
  NavState x;
  x.q_WB = rotation();
  x.p_WB = normal_vector(5.0);
  x.v_WB = normal_vector(2.0);
  x.gyro_bias = normal_vector(0.02);
  x.accel_bias = normal_vector(0.1);
  return x;
}

Quaternion rotation_of(const Vector3d& phi) {
  const double angle = phi.norm();
  if (angle == 0.0) return Quaternion::Identity();
  return Quaternion(Eigen::AngleAxisd(angle, phi / angle));
}

NavState perturbed(const NavState& x, const BodyVector& e) {
  NavState y = x;
  y.q_WB = x.q_WB * rotation_of(e.segment<3>(body::kAttitude));
  y.p_WB += e.segment<3>(body::kPosition);
  y.v_WB += e.segment<3>(body::kVelocity);
  y.gyro_bias += e.segment<3>(body::kGyroBias);
  y.accel_bias += e.segment<3>(body::kAccelBias);
  return y;
}

BodyVector error_of(const NavState& truth, const NavState& estimate) {
  const Eigen::AngleAxisd rotation(Eigen::Quaterniond(estimate.q_WB.conjugate() * truth.q_WB));
  BodyVector e;
  e << rotation.angle() * rotation.axis(), truth.p_WB - estimate.p_WB, truth.v_WB - estimate.v_WB,
      truth.gyro_bias - estimate.gyro_bias, truth.accel_bias - estimate.accel_bias;
  return e;
}

}  // namespace rio::test

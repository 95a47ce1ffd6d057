// SPDX-License-Identifier: BSD-3-Clause
// Seeded random vectors, rotations and states for tests, and the body error between two states.
#pragma once

#include <random>

#include "rio/types.hpp"

namespace rio::test {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double normal(double sigma = 1.0) { return sigma * normal_(engine_); }
  /// Uniform in 0..n-1.
  std::size_t index(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(engine_);
  }

  /// Independent normal components.
  Vector3d normal_vector(double sigma = 1.0) {
    const double x = normal(sigma);
    const double y = normal(sigma);
    return {x, y, normal(sigma)};
  }
  /// Uniform on the unit sphere.
  Vector3d direction() { return normal_vector().normalized(); }
  /// Uniform on the rotations.
  Quaternion rotation() {
    const double w = normal();
    const Vector3d v = normal_vector();
    return Quaternion(w, v.x(), v.y(), v.z()).normalized();
  }
  /// Any attitude, metres, metres per second and biases of a bad MEMS sensor.
  NavState state() {
    NavState x;
    x.q_WB = rotation();
    x.p_WB = normal_vector(5.0);
    x.v_WB = normal_vector(2.0);
    x.gyro_bias = normal_vector(0.02);
    x.accel_bias = normal_vector(0.1);
    return x;
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

using BodyVector = Eigen::Matrix<double, body::kSize, 1>;

/// Rotation by a rotation vector, by way of Eigen's axis and angle.
inline Quaternion rotation_of(const Vector3d& phi) {
  const double angle = phi.norm();
  if (angle == 0.0) return Quaternion::Identity();
  return Quaternion(Eigen::AngleAxisd(angle, phi / angle));
}

/// The state whose error relative to x is e: attitude on the right, the rest added.
inline NavState perturbed(const NavState& x, const BodyVector& e) {
  NavState y = x;
  y.q_WB = x.q_WB * rotation_of(e.segment<3>(body::kAttitude));
  y.p_WB += e.segment<3>(body::kPosition);
  y.v_WB += e.segment<3>(body::kVelocity);
  y.gyro_bias += e.segment<3>(body::kGyroBias);
  y.accel_bias += e.segment<3>(body::kAccelBias);
  return y;
}

/// The error of `estimate`: perturbed(estimate, result) is `truth`.
inline BodyVector error_of(const NavState& truth, const NavState& estimate) {
  const Eigen::AngleAxisd rotation(Eigen::Quaterniond(estimate.q_WB.conjugate() * truth.q_WB));
  BodyVector e;
  e << rotation.angle() * rotation.axis(), truth.p_WB - estimate.p_WB, truth.v_WB - estimate.v_WB,
      truth.gyro_bias - estimate.gyro_bias, truth.accel_bias - estimate.accel_bias;
  return e;
}

}  // namespace rio::test

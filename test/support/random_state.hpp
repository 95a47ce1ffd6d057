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
  Vector3d normal_vector(double sigma = 1.0);
  /// Uniform on the unit sphere.
  Vector3d direction();
  /// Uniform on the rotations.
  Quaternion rotation();
  /// Any attitude, metres, metres per second and biases of a bad MEMS sensor.
  NavState state();

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

using BodyVector = Eigen::Matrix<double, body::kSize, 1>;

/// Rotation by a rotation vector, by way of Eigen's axis and angle.
Quaternion rotation_of(const Vector3d& phi);

/// The state whose error relative to x is e: attitude on the right, the rest added.
NavState perturbed(const NavState& x, const BodyVector& e);

/// The error of `estimate`: perturbed(estimate, result) is `truth`.
BodyVector error_of(const NavState& truth, const NavState& estimate);

}  // namespace rio::test

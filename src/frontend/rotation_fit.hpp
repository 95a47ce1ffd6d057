// SPDX-License-Identifier: BSD-3-Clause
// The rotations that fit a quadratic form of their elements: (E5) of frontend/mounting_search.hpp.
#pragma once

#include <array>

#include "rio/frontend/mounting_search.hpp"

namespace rio {

/// a^T b
inline MountingSearch::Block dot(const MountingSearch::Block& a, const MountingSearch::Block& b) {
  return a.transpose() * b;
}
/// (vec R, end)
MountingSearch::Block stacked(const Matrix3d& R, double end);
/// Derivative of (vec(R Exp(phi)), 1) by phi.
MountingSearch::Block stacked_jacobian(const Matrix3d& R);
/// Log(A^T B) [rad].
Vector3d turn_between(const Matrix3d& A, const Matrix3d& B);

/// f(R) = x^T M x with x = (vec R, 1), and the prior.
struct RotationCost {
  MountingSearch::Block M;
  Matrix3d prior;
  double prior_information = 0.0;  ///< [1/rad^2]

  double operator()(const Matrix3d& R) const;
  Vector3d offset(const Matrix3d& R) const { return turn_between(prior, R); }
};

struct RotationMinimum {
  Matrix3d R;
  double cost = 0.0;
};

/// Those reached by Levenberg and Marquardt's method from the 24 rotations of the prior by right
/// angles.
std::array<RotationMinimum, 24> rotation_minima(const RotationCost& cost);

}  // namespace rio

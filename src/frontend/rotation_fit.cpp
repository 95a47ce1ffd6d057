// SPDX-License-Identifier: BSD-3-Clause
#include "rotation_fit.hpp"

#include "rio/core/small_cholesky.hpp"
#include "rio/core/so3.hpp"

namespace rio {

namespace {

using Block = MountingSearch::Block;

/// Levenberg-Marquardt from R.
RotationMinimum minimum_from(Matrix3d R, const RotationCost& cost) {
  constexpr int kIterations = 20;
  constexpr double kSmall = 1e-6;  // step [rad]
  double f = cost(R);
  double damping = 1e-3;
  for (int i = 0; i < kIterations; ++i) {
    const Block J = stacked_jacobian(R);
    const Block MJ = cost.M * J;
    const Vector3d gradient = dot(MJ, stacked(R, 1.0)) + cost.prior_information * cost.offset(R);
    Matrix3d H = dot(J, MJ);
    H.diagonal().array() += cost.prior_information;
    H.diagonal() *= 1.0 + damping;
    const Vector3d step = -SmallCholesky<3>(H).solve(gradient);
    const Matrix3d next = R * quaternion_exp(step).toRotationMatrix();
    const double there = cost(next);
    if (!(there < f)) {
      damping = 10.0 * damping + 1e-3;
      continue;
    }
    damping *= 0.1;
    R = next;
    f = there;
    if (step.norm() < kSmall) break;
  }
  return {R, f};
}

}  // namespace

Block stacked(const Matrix3d& R, double end) {
  Block x(10, 1);
  for (int i = 0; i < 9; ++i) x(i) = R.data()[i];
  x(9) = end;
  return x;
}

Block stacked_jacobian(const Matrix3d& R) {
  Block J(10, 3);
  for (int i = 0; i < 3; ++i) J.col(i) = stacked(R * skew(Vector3d::Unit(i)), 0.0);
  return J;
}

Vector3d turn_between(const Matrix3d& A, const Matrix3d& B) {
  return quaternion_log(Quaternion(Matrix3d(A.transpose() * B)));
}

double RotationCost::operator()(const Matrix3d& R) const {
  const Block x = stacked(R, 1.0);
  return dot(x, M * x)(0) + prior_information * offset(R).squaredNorm();
}

std::array<RotationMinimum, 24> rotation_minima(const RotationCost& cost) {
  std::array<RotationMinimum, 24> all;
  std::size_t n = 0;
  for (const Matrix3d& P : right_angles()) all[n++] = minimum_from(cost.prior * P, cost);
  return all;
}

}  // namespace rio

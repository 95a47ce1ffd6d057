// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/reliability.hpp"

#include <Eigen/Eigenvalues>

#include "rio/core/small_cholesky.hpp"

namespace rio {

void Reliability::add(const DopplerModel::Measurement& z, const Vector3d& v_S) {
  const auto expected = DopplerModel::expected_direction(z, z.direction_S, v_S);
  add(expected.u_S, expected.covariance, expected.variance);
}

void Reliability::add(const Vector3d& u, const Matrix3d& covariance, double variance) {
  S_ += u * u.transpose() / variance;
  C_ += covariance / variance;
}

Matrix3d Reliability::matrix() const {
  constexpr double kRegular = 1e-9;  // S of fewer than three directions is singular
  if (!(S_.trace() > 0.0)) return Matrix3d::Identity();
  const Matrix3d regular = kRegular * S_.trace() * Matrix3d::Identity();
  const SmallCholesky<3> cholesky(S_ + regular);
  const Matrix3d& root = cholesky.L();
  const Matrix3d inverse = cholesky.whitened(Matrix3d(Matrix3d::Identity()));
  const Matrix3d half_white = inverse * C_;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> errors(Matrix3d(half_white * inverse.transpose()));
  const Vector3d kept = 1.0 - errors.eigenvalues().array().min(1.0);
  const Matrix3d& V = errors.eigenvectors();
  Matrix3d V_kept = V;
  for (int i = 0; i < 3; ++i) V_kept.col(i) *= kept[i];
  const Matrix3d left = root * V_kept;
  const Matrix3d right = V.transpose() * inverse;
  return left * right;
}

}  // namespace rio

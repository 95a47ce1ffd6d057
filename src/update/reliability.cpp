// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/reliability.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

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
  constexpr double kRegular = 1e-9;  // of fewer than three directions S is singular
  if (!(S_.trace() > 0.0)) return Matrix3d::Identity();
  const Eigen::LLT<Matrix3d> llt(S_ + kRegular * S_.trace() * Matrix3d::Identity());
  const Matrix3d root = llt.matrixL();
  const Matrix3d inverse = root.inverse();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> errors(
      Matrix3d(inverse * C_ * inverse.transpose()));
  const Vector3d kept = 1.0 - errors.eigenvalues().array().min(1.0);
  const Matrix3d& V = errors.eigenvectors();
  return root * V * kept.asDiagonal() * V.transpose() * inverse;
}

}  // namespace rio

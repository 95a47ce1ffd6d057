// SPDX-License-Identifier: BSD-3-Clause
#include "support/window_cost.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "support/differentiated_cost.hpp"

namespace rio::test {

ImuCost::ImuCost(const Preintegration& imu, double gravity, const NavState& i, const NavState& j)
    : first(i),
      last(j),
      increment(imu.increment()),
      gyro_bias(imu.gyro_bias()),
      accel_bias(imu.accel_bias()),
      A(imu.transition()),
      whitening(Matrix15d(imu.covariance().llt().matrixL()).inverse()),
      seconds(to_seconds(imu.duration())),
      g_W(0.0, 0.0, -gravity) {}

void PriorCost::factorise(const Eigen::MatrixXd& A, const Eigen::VectorXd& g) {
  const Eigen::VectorXd scale =
      A.diagonal().unaryExpr([](double a) { return a > 0.0 ? 1.0 / std::sqrt(a) : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      (scale.asDiagonal() * A * scale.asDiagonal()).eval());
  constexpr double kRounding = 1e-12;  // of a unit diagonal of some hundred rows
  const Eigen::Index n = A.rows();
  const Eigen::Index zero = (eigen.eigenvalues().array() < kRounding).count();
  const Eigen::MatrixXd V = eigen.eigenvectors().rightCols(n - zero);
  const Eigen::VectorXd s = eigen.eigenvalues().tail(n - zero).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double d) { return d > 0.0 ? 1.0 / d : 0.0; });
  root = s.asDiagonal() * V.transpose() * inverse.asDiagonal();
  offset = s.cwiseInverse().asDiagonal() * (V.transpose() * (scale.asDiagonal() * g));
}

}  // namespace rio::test

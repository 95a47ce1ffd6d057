// SPDX-License-Identifier: BSD-3-Clause
#include "support/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace rio::test {

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A, Eigen::MatrixXd* vectors) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      A, vectors != nullptr ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
  if (vectors != nullptr) *vectors = solver.eigenvectors();
  return solver.eigenvalues();
}

}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
#include "support/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace rio::test {

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
#include "support/symmetric.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <stdexcept>

namespace rio::test {

using Eigen::MatrixXd;

Eigen::VectorXd eigenvalues(const MatrixXd& A, MatrixXd* vectors) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(
      A, vectors != nullptr ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
  if (vectors != nullptr) *vectors = solver.eigenvectors();
  return solver.eigenvalues();
}

bool is_positive_definite(const MatrixXd& A) {
  return Eigen::LLT<MatrixXd>(A).info() == Eigen::Success;
}

MatrixXd root_of(const MatrixXd& A) {
  const Eigen::LLT<MatrixXd> llt(A);
  if (llt.info() != Eigen::Success) throw std::domain_error("not positive definite");
  return llt.matrixL();
}

MatrixXd solve(const MatrixXd& A, const MatrixXd& B) {
  const Eigen::LLT<MatrixXd> llt(A);
  if (llt.info() != Eigen::Success) throw std::domain_error("not positive definite");
  return llt.solve(B);
}

MatrixXd whitening(const MatrixXd& A) {
  const MatrixXd I = MatrixXd::Identity(A.rows(), A.cols());
  return root_of(A).triangularView<Eigen::Lower>().solve(I);
}

MatrixXd whitened(const MatrixXd& C, const MatrixXd& A) {
  const MatrixXd W = whitening(A);
  return W * C * W.transpose();
}

}  // namespace rio::test

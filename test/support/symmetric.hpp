// SPDX-License-Identifier: BSD-3-Clause
// Algebra of symmetric matrices of any size: compiled once, as each size takes a compiler seconds.
#pragma once

#include <Eigen/Core>

namespace rio::test {

/// In rising order.  @param A symmetric  @param vectors if given, the eigenvectors, as columns
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A, Eigen::MatrixXd* vectors = nullptr);

bool is_positive_definite(const Eigen::MatrixXd& A);

// Of a positive definite matrix; std::domain_error if it is not.

/// L of A = L L^T.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& A);
/// A^-1 B.
Eigen::MatrixXd solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// L^-1, A = L L^T.
Eigen::MatrixXd whitening(const Eigen::MatrixXd& A);
/// L^-1 C L^-T, A = L L^T: the identity if C is A.
Eigen::MatrixXd whitened(const Eigen::MatrixXd& C, const Eigen::MatrixXd& A);

}  // namespace rio::test

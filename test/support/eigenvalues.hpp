// SPDX-License-Identifier: BSD-3-Clause
// Eigenvalues of symmetric matrices of any size: compiled once, as they take a compiler seconds.
#pragma once

#include <Eigen/Core>

namespace rio::test {

/// In rising order.  @param A symmetric  @param vectors if given, the eigenvectors, as columns
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A, Eigen::MatrixXd* vectors = nullptr);

}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
// Eigenvalues of symmetric matrices of any size: compiled once, as they take a compiler seconds.
#pragma once

#include <Eigen/Core>

namespace rio::test {

/// In rising order.  @param A symmetric
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);

}  // namespace rio::test

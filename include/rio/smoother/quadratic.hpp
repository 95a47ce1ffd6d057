// SPDX-License-Identifier: BSD-3-Clause
// In-place operations on the leading n unknowns of a quadratic x^T A x / 2 - g^T x. Only the lower
// triangle of the symmetric A is read and valid afterwards.
//
// (E1) new unknowns y, x = B y:  A <- B^T A B,  g <- B^T g
// (E2) independent noise of covariance E C E^T added to the unknowns E:
//      (A^-1 + E C E^T)^-1 = A - A E (C^-1 + E^T A E)^-1 E^T A                    (Woodbury 1950)
//      with C^-1 = 0 this marginalises the unknowns E
#pragma once

#include <Eigen/Core>

#include "rio/types.hpp"

namespace rio::quadratic {

/// (E1) for a B that is I except for the 3x3 block `own` at `at`.
void multiply_block(int n, int at, const Matrix3d& own, Eigen::MatrixXd* A, Eigen::VectorXd* g);

/// (E2), E the own.size() columns from `at` on, at most cholesky::kPanel, C^-1 = diag(own). No
/// effect if C^-1 + E^T A E is not positive definite: A has no information about them.
/// @param scratch of at least n rows and one column more than E
void subtract_projection(int n, int at, const Eigen::Ref<const Eigen::VectorXd>& own,
                         Eigen::MatrixXd* A, Eigen::VectorXd* g, Eigen::MatrixXd* scratch);

}  // namespace rio::quadratic

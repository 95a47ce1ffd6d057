// SPDX-License-Identifier: BSD-3-Clause
// Cholesky factor of a symmetric matrix of any size, compiled once.
#pragma once

#include <Eigen/Core>

namespace rio {

/// Lower triangle of A <- L with A = L L^T. Reads the lower triangle only. False if A is not
/// positive definite. Does not allocate.
bool factorise_in_place(Eigen::Ref<Eigen::MatrixXd> A);

}  // namespace rio

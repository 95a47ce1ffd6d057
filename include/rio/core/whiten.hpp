// SPDX-License-Identifier: BSD-3-Clause
// Whitening of a residual and its Jacobian. C++17.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace rio {

/// r <- L^-1 r, J <- L^-1 J with R = L L^T positive definite. Plain loops, because Eigen's solvers
/// would be instantiated for every model.
template <int kDim, int kDof>
void whiten(Eigen::Matrix<double, kDim, kDim> R, Eigen::Matrix<double, kDim, 1>* r,
            Eigen::Matrix<double, kDim, kDof>* J) {
  for (int i = 0; i < kDim; ++i) {
    for (int j = 0; j < i; ++j) {
      for (int k = 0; k < j; ++k) R(i, j) -= R(i, k) * R(j, k);
      R(i, j) /= R(j, j);
      R(i, i) -= R(i, j) * R(i, j);
      (*r)[i] -= R(i, j) * (*r)[j];
      for (int c = 0; c < kDof; ++c) (*J)(i, c) -= R(i, j) * (*J)(j, c);
    }
    R(i, i) = std::sqrt(R(i, i));
    (*r)[i] /= R(i, i);
    for (int c = 0; c < kDof; ++c) (*J)(i, c) /= R(i, i);
  }
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Rows of the update as dense matrices.
#pragma once

#include <span>

#include "rio/update/linear_rows.hpp"
#include "support/random_matrix.hpp"
#include "support/symmetric.hpp"

namespace rio::test {

struct DenseRows {
  MatrixXd H;
  MatrixXd R;  ///< covariance of the noise
  VectorXd r;  ///< residuals

  /// H^T R^-1 [H r].
  MatrixXd information() const {
    MatrixXd H_r(H.rows(), H.cols() + 1);
    H_r << H, r;
    return H.transpose() * solve(R, H_r);
  }
};

/// @param n columns of H
inline DenseRows dense_rows(std::span<const LinearRow> rows, int n) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  DenseRows d{MatrixXd::Zero(count, n), MatrixXd::Zero(count, count), VectorXd::Zero(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const LinearRow& row = rows[static_cast<std::size_t>(i)];
    row.for_each_segment([&](int column, const double* h, int length) {
      for (int k = 0; k < length; ++k) d.H(i, column + k) += h[k];
    });
    d.R(i, i) = row.variance;
    d.r[i] = row.residual;
  }
  return d;
}

}  // namespace rio::test

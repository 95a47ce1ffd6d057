// SPDX-License-Identifier: BSD-3-Clause
// Dense matrices: of standard normal numbers, how two are compared, and of rows of the update.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <span>

#include "rio/sim/random.hpp"
#include "rio/update/linear_rows.hpp"
#include "support/symmetric.hpp"

namespace rio::test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

inline MatrixXd random_matrix(sim::Random& random, Eigen::Index rows, Eigen::Index cols) {
  return MatrixXd::NullaryExpr(rows, cols, [&random] { return random.normal(); });
}

/// No element differs by more than this share of the largest one.
inline void expect_close(const MatrixXd& actual, const MatrixXd& expected, double relative) {
  ASSERT_EQ(actual.rows(), expected.rows());
  ASSERT_EQ(actual.cols(), expected.cols());
  if (expected.size() == 0) return;
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), relative * expected.cwiseAbs().maxCoeff());
}

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

// SPDX-License-Identifier: BSD-3-Clause
// Dense matrices: of standard normal numbers, and how two are compared.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "rio/sim/random.hpp"

namespace rio::test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

inline MatrixXd random_matrix(sim::Random& random, Eigen::Index rows, Eigen::Index cols) {
  MatrixXd m(rows, cols);
  for (Eigen::Index c = 0; c < cols; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) m(r, c) = random.normal();
  }
  return m;
}

/// No element differs by more than this share of the largest one.
inline void expect_close(const MatrixXd& actual, const MatrixXd& expected, double relative) {
  ASSERT_EQ(actual.rows(), expected.rows());
  ASSERT_EQ(actual.cols(), expected.cols());
  if (expected.size() == 0) return;
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), relative * expected.cwiseAbs().maxCoeff());
}

}  // namespace rio::test

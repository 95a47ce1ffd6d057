// SPDX-License-Identifier: BSD-3-Clause
#include "rio/core/small_cholesky.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rio {
namespace {

using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// Of eigenvalues between 1 and some 50.
Matrix5d positive_matrix() {
  Matrix5d B;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) B(i, j) = std::sin(1.0 + 3.0 * i * i + 7.0 * j);
  }
  return B * B.transpose() + Matrix5d::Identity();
}

TEST(SmallCholesky, FactorSolutionAndInverseAreThoseOfTheMatrix) {
  const Matrix5d A = positive_matrix();
  const SmallCholesky<5> cholesky(A);
  ASSERT_TRUE(cholesky.positive());
  const Matrix5d& L = cholesky.L();
  EXPECT_LT((L * L.transpose() - A).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_TRUE(L.isLowerTriangular(0.0));
  Eigen::Matrix<double, 5, 2> b;
  b << 1.0, 2.0, -3.0, 4.0, 5.0, 6.0, -7.0, 8.0, 9.0, 10.0;
  EXPECT_LT((L * cholesky.whitened(b) - b).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((A * cholesky.solve(b) - b).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_TRUE((A * cholesky.inverse()).isIdentity(1e-13));
  EXPECT_NEAR(cholesky.determinant() / A.determinant(), 1.0, 1e-12);
}

TEST(SmallCholesky, ReadsTheLowerTriangleAlone) {
  Matrix5d A = positive_matrix();
  const Matrix5d L = SmallCholesky<5>(A).L();
  A.triangularView<Eigen::StrictlyUpper>().setConstant(99.0);
  EXPECT_EQ(SmallCholesky<5>(A).L(), L);
}

TEST(SmallCholesky, RefusesWhatIsNotPositiveDefinite) {
  Matrix5d A = positive_matrix();
  A(3, 3) = -1.0;
  EXPECT_FALSE(SmallCholesky<5>(A).positive());
  A = positive_matrix();
  A(4, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(SmallCholesky<5>(A).positive());
  EXPECT_FALSE(SmallCholesky<5>(Matrix5d::Zero()).positive());
}

}  // namespace
}  // namespace rio

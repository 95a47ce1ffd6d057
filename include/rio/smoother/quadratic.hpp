// SPDX-License-Identifier: BSD-3-Clause
// Operations on the leading n unknowns of a quadratic x^T A x / 2 - g^T x in place. Of the
// symmetric A only the lower triangle is read and right afterwards.
//
// (E1) new unknowns y, x = B y:  A <- B^T A B,  g <- B^T g
// (E2) an own error of covariance E C E^T:
//      (A^-1 + E C E^T)^-1 = A - A E (C^-1 + E^T A E)^-1 E^T A                    (Woodbury 1950)
//      with C^-1 = 0 this marginalises the unknowns E
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "rio/smoother/block_cholesky.hpp"
#include "rio/types.hpp"

namespace rio::quadratic {

/// (E1) for a B that is I but for the 3x3 block `own` at `at`.
inline void multiply_block(int n, int at, const Matrix3d& own, Eigen::MatrixXd* A,
                           Eigen::VectorXd* g) {
  auto columns = A->block(at, at, n - at, 3);
  for (int r = 0; r < columns.rows(); ++r) columns.row(r) = (columns.row(r) * own).eval();
  for (int c = 0; c < at + 3; ++c) {
    A->block<3, 1>(at, c) = (own.transpose() * A->block<3, 1>(at, c)).eval();
  }
  g->segment<3>(at) = (own.transpose() * g->segment<3>(at)).eval();
}

/// (E2), E the `width` columns from `at` on, at most cholesky::kPanel, C^-1 = `own` I. Nothing, if
/// C^-1 + E^T A E is not positive definite: A knows nothing of them.
/// @param scratch of at least n rows and width + 1 columns
inline void subtract_projection(int n, int at, int width, double own, Eigen::MatrixXd* A,
                                Eigen::VectorXd* g, Eigen::MatrixXd* scratch) {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, cholesky::kPanel, cholesky::kPanel> L =
      A->block(at, at, width, width).selfadjointView<Eigen::Lower>();
  auto W = scratch->topLeftCorner(n, width);  // A E
  W.topRows(at) = A->block(at, 0, width, at).transpose();
  W.middleRows(at, width) = L;
  W.bottomRows(n - at - width) = A->block(at + width, at, n - at - width, width);
  L.diagonal().array() += own;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(L);
  if (llt.info() != Eigen::Success) return;
  cholesky::divide_right(L, W);
  auto y = scratch->col(width).head(width);
  y = g->segment(at, width);
  L.triangularView<Eigen::Lower>().solveInPlace(y);
  A->topLeftCorner(n, n).selfadjointView<Eigen::Lower>().rankUpdate(W, -1.0);
  g->head(n).noalias() -= W * y;
}

}  // namespace rio::quadratic

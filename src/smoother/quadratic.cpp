// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/quadratic.hpp"

#include "rio/core/dense_cholesky.hpp"
#include "rio/smoother/block_cholesky.hpp"

namespace rio::quadratic {

void multiply_block(int n, int at, const Matrix3d& own, Eigen::MatrixXd* A, Eigen::VectorXd* g) {
  auto columns = A->block(at, at, n - at, 3);
  for (int r = 0; r < columns.rows(); ++r) columns.row(r) = (columns.row(r) * own).eval();
  for (int c = 0; c < at + 3; ++c) {
    A->block<3, 1>(at, c) = (own.transpose() * A->block<3, 1>(at, c)).eval();
  }
  g->segment<3>(at) = (own.transpose() * g->segment<3>(at)).eval();
}

void subtract_projection(int n, int at, const Eigen::Ref<const Eigen::VectorXd>& own,
                         Eigen::MatrixXd* A, Eigen::VectorXd* g, Eigen::MatrixXd* scratch) {
  const auto width = static_cast<int>(own.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, cholesky::kPanel, cholesky::kPanel> L =
      A->block(at, at, width, width).selfadjointView<Eigen::Lower>();
  auto W = scratch->topLeftCorner(n, width);  // A E
  W.topRows(at) = A->block(at, 0, width, at).transpose();
  W.middleRows(at, width) = L;
  W.bottomRows(n - at - width) = A->block(at + width, at, n - at - width, width);
  L.diagonal() += own;
  if (!factorise_in_place(L)) return;
  cholesky::divide_right(L, W);
  auto y = scratch->col(width).head(width);
  y = g->segment(at, width);
  L.triangularView<Eigen::Lower>().solveInPlace(y);
  A->topLeftCorner(n, n).selfadjointView<Eigen::Lower>().rankUpdate(W, -1.0);
  g->head(n).noalias() -= W * y;
}

}  // namespace rio::quadratic

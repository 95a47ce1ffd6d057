// SPDX-License-Identifier: BSD-3-Clause
// Stage 6 of the EKF: rows -> correction, and the covariance after it.
//
// (E1) W = P H^T L^-T, S = H P H^T + R = L L^T, dx = W L^-1 r, P <- P - W W^T, in panels of rows
// The next panel's innovation is corrected by what the panels before it did: the result is that of
// all rows at once. Nothing allocates after construction.
#pragma once

#include <Eigen/Core>

#include "rio/update/covariance.hpp"

namespace rio {

class PanelUpdate {
 public:
  explicit PanelUpdate(int capacity);

  /// All rows of the batch at once; `dx` is the correction. Of P the lower triangle is that after
  /// it. False, with P unchanged, if an innovation covariance is not positive definite or the
  /// result is not finite.
  bool apply(const RowBatch& batch, Covariance* covariance, Eigen::VectorXd* dx);

 private:
  static constexpr int kPanel = 32;  // rows per rank update: the packing buffers stay on the stack
  using PanelMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kPanel, kPanel>;

  /// One panel; false, with P unchanged.
  bool panel(const RowBatch& batch, std::size_t first_block, std::size_t end_block, Eigen::Index m,
             Eigen::Ref<Eigen::MatrixXd> P, Eigen::VectorXd* dx);

  /// W <- W L^-T.
  void solve(const PanelMatrix& L, Eigen::Ref<Eigen::MatrixXd> W);

  /// R on the lower triangle of S.
  static void add_noise(const RowBatch& batch, std::size_t first_block, std::size_t end_block,
                        PanelMatrix* S);

  Eigen::MatrixXd backup_;
  Eigen::MatrixXd W_;
  Eigen::VectorXd diagonal_;
  Eigen::VectorXd combined_;  ///< sum of columns
};

}  // namespace rio

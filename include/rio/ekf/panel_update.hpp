// SPDX-License-Identifier: BSD-3-Clause
// Stage 5 of the EKF: the Kalman update, rows -> correction and covariance.
//
// (E1) W = P H^T L^-T, S = H P H^T + R = L L^T, dx = W L^-1 r, P <- P - W W^T, in panels of rows
// The innovation of a panel is corrected for the panels before it, so that the result is that of
// all rows at once (sequential update). Nothing allocates after construction.
#pragma once

#include <Eigen/Core>

#include "rio/update/covariance.hpp"

namespace rio {

class PanelUpdate {
 public:
  explicit PanelUpdate(int capacity);

  /// Applies all rows of the batch; `dx` is the correction. Afterwards only the lower triangle of P
  /// is valid. False, with P unchanged, if an innovation covariance is not positive definite, or
  /// the result is not finite or has a negative variance.
  bool apply(const RowBatch& batch, Covariance* covariance, Eigen::VectorXd* dx);

 private:
  static constexpr int kPanel = 32;  // rows: Eigen's packing buffers then stay on the stack
  using PanelMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kPanel, kPanel>;

  /// Applies one panel of m rows; if it fails, false and P unchanged.
  bool panel(const LinearRow* rows, Eigen::Index m, Eigen::Ref<Eigen::MatrixXd> P,
             Eigen::VectorXd* dx);

  /// W <- W L^-T.
  void solve(const PanelMatrix& L, Eigen::Ref<Eigen::MatrixXd> W);

  Eigen::MatrixXd backup_;
  Eigen::MatrixXd W_;
  Eigen::VectorXd diagonal_;
  Eigen::VectorXd combined_;  ///< sum of columns
};

}  // namespace rio

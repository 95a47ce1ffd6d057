// SPDX-License-Identifier: BSD-3-Clause
// Stage 6 of the EKF: many rows that tell of few directions of the state are as few rows.
//
// The Dopplers of a scan are all of one velocity: h_i = c_i^T B with three rows B. An update costs
// n^2 a row, so they are summed up first:
// (E1) R^-1/2 H = L B    rows of B orthonormal: Gram-Schmidt, the longest row that is left first
// (E2) L = Q T, so that |L B dx - r|^2 = |T B dx - Q^T r|^2 + const: the rows T B of variance 1
// with
//      the residuals Q^T r give the same update
// Reference: Golub and Van Loan, Matrix Computations, 2013, 5.2 (QR), 5.3 (least squares).
#pragma once

#include <Eigen/Core>
#include <array>

#include "rio/update/linear_rows.hpp"

namespace rio {

class RowCompression {
 public:
  /// @param capacity rows of a batch
  explicit RowCompression(std::size_t capacity);

  /// The same update in fewer rows; valid until the next call. Only single rows one after the other
  /// that touch the same columns are summed up.
  const RowBatch& compress(const RowBatch& batch);

 private:
  static constexpr int kMaxRank = 4;  // three components of a velocity, one error of all directions
  static constexpr int kColumns = static_cast<int>(LinearRow::kMaxColumns);

  /// Rows [begin, end) of the batch, all of single blocks. False, and nothing is done, if they are
  /// of more than kMaxRank directions.
  bool compress_run(const RowBatch& batch, std::size_t begin, std::size_t end);

  RowBatch out_;
  Eigen::Matrix<double, kColumns, Eigen::Dynamic> rows_;    // R^-1/2 H, one row a column
  Eigen::Matrix<double, Eigen::Dynamic, kMaxRank> factor_;  // L
  Eigen::Matrix<double, kColumns, kMaxRank> basis_;         // B^T
  Eigen::VectorXd residual_;                                // R^-1/2 r
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Stage 5 of the EKF: measurement compression by QR: many rows that measure few directions of the
// state are replaced by as few rows.
//
// The Dopplers of a scan all measure one velocity: h_i = c_i^T B with three rows B. An update costs
// O(n^2) per row, so they are compressed first:
// (E1) R^-1/2 H = L B    rows of B orthonormal: Gram-Schmidt, the longest remaining row first
// (E2) L = Q T, so that |L B dx - r|^2 = |T B dx - Q^T r|^2 + const: the rows T B of variance 1
//      with the residuals Q^T r give the same update
// The Dopplers of a scan share the noise of one gyro sample, of variance s per axis, with the
// coefficients of the gyro bias, G (models/doppler.hpp):
// (E3) cov = I + s G G^T = L L^T of the few rows of (E2), which are replaced by L^-1 of them
// Reference: Golub and Van Loan, Matrix Computations, 2013, 5.2 (QR), 5.3 (least squares).
#pragma once

#include <Eigen/Core>

#include "rio/core/static_vector.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

class RowCompression {
 public:
  /// @param capacity rows of a batch
  explicit RowCompression(std::size_t capacity);

  /// The same update in fewer rows; valid until the next call. Only consecutive blocks of one row
  /// that touch the same columns are compressed.
  /// @param rate_variance s of (E3), of all rows compressed; 0 = no shared noise [rad^2/s^2]
  const RowBatch& compress(const RowBatch& batch, double rate_variance);

 private:
  static constexpr int kMaxRank = 3;  // the components of a velocity
  static constexpr int kColumns = static_cast<int>(LinearRow::kMaxColumns);

  /// Compresses rows [begin, end) of the batch, each a block of its own. False, and nothing is
  /// appended, if they span more than kMaxRank directions or a variance is not positive.
  bool compress_run(const RowBatch& batch, std::size_t begin, std::size_t end,
                    double rate_variance);

  using Rows = StaticVector<LinearRow, kMaxRank>;
  /// (E3)
  static void whiten(double rate_variance, Rows* rows);

  RowBatch out_;
  Eigen::Matrix<double, kColumns, Eigen::Dynamic> rows_;    // R^-1/2 H, one row a column
  Eigen::Matrix<double, Eigen::Dynamic, kMaxRank> factor_;  // L
  Eigen::Matrix<double, kColumns, kMaxRank> basis_;         // B^T
  Eigen::VectorXd residual_;                                // R^-1/2 r
};

}  // namespace rio

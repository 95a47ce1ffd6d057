// SPDX-License-Identifier: BSD-3-Clause
// Symmetric matrices of any size, kept in their lower triangle.
#pragma once

#include <Eigen/Core>

namespace rio {

/// Lower triangle of A <- L with A = L L^T. Reads the lower triangle only. False if A is not
/// positive definite. Does not allocate.
bool factorise_in_place(Eigen::Ref<Eigen::MatrixXd> A);

/// Upper triangle <- lower triangle: symmetric to the last bit.
inline void mirror_lower(Eigen::Ref<Eigen::MatrixXd> A) {
  constexpr Eigen::Index kStrip = 4;  // columns written together: the reads are contiguous
  const Eigen::Index n = A.cols();
  Eigen::Index c = 0;
  for (; c + kStrip <= n; c += kStrip) {
    for (Eigen::Index r = 0; r < c; ++r) {
      A.block<1, kStrip>(r, c) = A.block<kStrip, 1>(c, r).transpose();
    }
    for (Eigen::Index k = 1; k < kStrip; ++k) {
      for (Eigen::Index r = c; r < c + k; ++r) A(r, c + k) = A(c + k, r);
    }
  }
  for (; c < n; ++c) {
    for (Eigen::Index r = 0; r < c; ++r) A(r, c) = A(c, r);
  }
}

}  // namespace rio

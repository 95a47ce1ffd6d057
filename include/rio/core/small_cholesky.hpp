// SPDX-License-Identifier: BSD-3-Clause
// Cholesky factor of a small symmetric matrix. C++17.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace rio {

/// A = L L^T; reads the lower triangle of A. Plain loops, because each size of Eigen's solvers
/// costs a second of compile time.
template <int kSize>
class SmallCholesky {
 public:
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  explicit SmallCholesky(const Matrix& A) : L_(Matrix::Zero()) {
    for (int j = 0; j < kSize; ++j) {
      double pivot = A(j, j);
      for (int k = 0; k < j; ++k) pivot -= L_(j, k) * L_(j, k);
      if (!(pivot > 0.0)) return;
      L_(j, j) = std::sqrt(pivot);
      for (int i = j + 1; i < kSize; ++i) {
        double sum = A(i, j);
        for (int k = 0; k < j; ++k) sum -= L_(i, k) * L_(j, k);
        L_(i, j) = sum / L_(j, j);
      }
    }
    positive_ = true;
  }

  /// A is positive definite; otherwise the results below are meaningless.
  bool positive() const { return positive_; }
  const Matrix& L() const { return L_; }

  /// det A
  double determinant() const { return L_.diagonal().prod() * L_.diagonal().prod(); }

  /// L^-1 b
  template <int kColumns>
  Eigen::Matrix<double, kSize, kColumns> whitened(Eigen::Matrix<double, kSize, kColumns> b) const {
    for (int c = 0; c < kColumns; ++c) {
      for (int i = 0; i < kSize; ++i) {
        for (int k = 0; k < i; ++k) b(i, c) -= L_(i, k) * b(k, c);
        b(i, c) /= L_(i, i);
      }
    }
    return b;
  }
  /// A^-1 b
  template <int kColumns>
  Eigen::Matrix<double, kSize, kColumns> solve(
      const Eigen::Matrix<double, kSize, kColumns>& b) const {
    Eigen::Matrix<double, kSize, kColumns> x = whitened(b);
    for (int c = 0; c < kColumns; ++c) {
      for (int i = kSize - 1; i >= 0; --i) {
        for (int k = i + 1; k < kSize; ++k) x(i, c) -= L_(k, i) * x(k, c);
        x(i, c) /= L_(i, i);
      }
    }
    return x;
  }
  /// A^-1
  Matrix inverse() const { return solve(Matrix(Matrix::Identity())); }

 private:
  Matrix L_;
  bool positive_ = false;
};

/// R is the covariance of a noise: finite, symmetric up to round-off, positive definite.
template <int kSize>
bool is_definite(const Eigen::Matrix<double, kSize, kSize>& R) {
  constexpr double kRoundOff = 1e-6;  // of a correlation, in single precision
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < i; ++j) {
      if (!(std::abs(R(i, j) - R(j, i)) <= kRoundOff * std::sqrt(R(i, i) * R(j, j)))) return false;
    }
  }
  return SmallCholesky<kSize>(R).positive();
}

}  // namespace rio

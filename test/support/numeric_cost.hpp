// SPDX-License-Identifier: BSD-3-Clause
// Ceres cost of a residual, with numerical derivatives. Automatic ones would take a minute of
// compiler, and no fewer evaluations.
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

namespace rio::test {

/// Residual r of the parameter blocks.
using Residual = std::function<void(const double* const* blocks, double* r)>;

/// The cost |A r(x) - b|^2 / 2, or |r(x)|^2 / 2. Derivatives of r by five points: with the step h
/// the error is of the order h^4 of the fifth derivative, and h^-1 of rounding, both below 1e-11
/// for parameters of the order of 1.
class NumericCost final : public ceres::CostFunction {
 public:
  /// @param sizes of the blocks
  NumericCost(Residual residual, const std::vector<int>& sizes, int rows)
      : residual_(std::move(residual)), rows_(rows) {
    set_num_residuals(rows);
    mutable_parameter_block_sizes()->assign(sizes.begin(), sizes.end());
  }
  /// @param A, b the linear map behind the residual, of A.cols() rows
  NumericCost(Residual residual, const std::vector<int>& sizes, Eigen::MatrixXd A,
              Eigen::VectorXd b)
      : NumericCost(std::move(residual), sizes, static_cast<int>(A.rows())) {
    rows_ = static_cast<int>(A.cols());
    A_ = std::move(A);
    b_ = std::move(b);
  }

  bool Evaluate(const double* const* blocks, double* r, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> out(r, num_residuals());
    out = mapped(evaluated(blocks));
    if (jacobians == nullptr) return true;
    for (std::size_t b = 0; b < parameter_block_sizes().size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      const Eigen::MatrixXd J = derivative(blocks, b);
      Eigen::Map<RowMajor>(jacobians[b], num_residuals(), J.cols()) = A_.size() > 0 ? A_ * J : J;
    }
    return true;
  }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::VectorXd evaluated(const double* const* blocks) const {
    Eigen::VectorXd r(rows_);
    residual_(blocks, r.data());
    return r;
  }
  Eigen::VectorXd mapped(const Eigen::VectorXd& r) const {
    return A_.size() > 0 ? Eigen::VectorXd(A_ * r - b_) : r;
  }
  Eigen::MatrixXd derivative(const double* const* blocks, std::size_t block) const {
    constexpr double kStep = 1e-4;
    const int size = parameter_block_sizes()[block];
    std::vector<const double*> moved(blocks, blocks + parameter_block_sizes().size());
    std::vector<double> x(blocks[block], blocks[block] + size);
    moved[block] = x.data();
    Eigen::MatrixXd J(rows_, size);
    for (int i = 0; i < size; ++i) {
      const double at = blocks[block][i];
      const auto shifted = [&](double steps) {
        x[static_cast<std::size_t>(i)] = at + steps * kStep;
        return evaluated(moved.data());
      };
      J.col(i) =
          (8.0 * (shifted(1.0) - shifted(-1.0)) - (shifted(2.0) - shifted(-2.0))) / (12.0 * kStep);
      x[static_cast<std::size_t>(i)] = at;
    }
    return J;
  }

  Residual residual_;
  int rows_ = 0;
  Eigen::MatrixXd A_;
  Eigen::VectorXd b_;
};

}  // namespace rio::test

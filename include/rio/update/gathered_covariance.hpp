// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: H P H^T of a few rows. The part of P that the rows touch is gathered into a small dense
// matrix; rows of one model share it, and little of it changes from landmark to landmark.
#pragma once

#include <Eigen/Core>
#include <array>

#include "rio/core/static_vector.hpp"
#include "rio/update/covariance.hpp"
#include "rio/update/gate.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

class GatheredCovariance {
 public:
  /// Sets P, which must not change until the last product.
  void begin(const Covariance& P) {
    P_ = &P;
    segments_.clear();
  }

  /// H P H^T of some rows.
  template <std::size_t kRows>
  auto product(const std::array<LinearRow, kRows>& rows) {
    constexpr auto kSize = static_cast<int>(kRows);
    Eigen::Matrix<double, kSize, kSize> S;
    multiply(rows.data(), kRows, S);
    return S;
  }
  /// Innovation covariance of a block of at most Gate::kMaxDof rows.
  using BlockMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Gate::kMaxDof, Gate::kMaxDof>;
  void innovation_covariance(const RowBatch& batch, const RowBlock& block, BlockMatrix* S);

 private:
  static constexpr int kCapacity = 32;  // columns; rows that touch more are multiplied one by one
  struct Segment {
    int column = 0;
    int length = 0;
    int at = 0;  ///< in the gathered matrix
    bool operator==(const Segment&) const = default;
  };
  using Segments = StaticVector<Segment, kCapacity>;

  void multiply(const LinearRow* rows, std::size_t count, Eigen::Ref<Eigen::MatrixXd> S);
  /// Gathers the columns that the rows touch. False if they are too many.
  bool gather(const LinearRow* rows, std::size_t count);
  /// Place in the gathered matrix of the segment that begins at `column`; -1 if there is none.
  int find(int column) const;

  const Covariance* P_ = nullptr;
  Segments segments_;
  int size_ = 0;
  Eigen::Matrix<double, kCapacity, kCapacity> gathered_;
};

}  // namespace rio

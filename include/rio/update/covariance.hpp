// SPDX-License-Identifier: BSD-3-Clause
// The covariance P of the whole error state: start, propagation, blocks that enter and leave.
// Corrections are in ekf/panel_update.hpp, re-expression in ekf/reexpression.hpp.
//
// (E1) propagate: P_bb <- Phi P_bb Phi^T + Q, P_bx <- Phi P_bx              (ICRA 2023, eq. 7)
// (E2) assign:    a block becomes J x + n: P_kk = J P J^T + N, P_kx = J P    (ibid., eq. 5, 10, 11)
// (E3) re-open:   P <- P + G V G^T, G = [tau I; I] on position and velocity
// ICRA 2023 is Michalczyk et al., ICRA 2023. Nothing here allocates after construction. Clones make
// P singular by design: it is never factorised.
#pragma once

#include <Eigen/Core>
#include <array>

#include "rio/options.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/gate.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

class Covariance {
 public:
  explicit Covariance(const Layout& layout)
      : layout_(layout),
        P_(Eigen::MatrixXd::Zero(layout.capacity(), layout.capacity())),
        scratch_(Eigen::MatrixXd::Zero(body::kSize, layout.capacity())),
        size_(layout.size(0)) {}

  int size() const { return size_; }
  /// The whole covariance, symmetric to the last bit.
  Eigen::Ref<const Eigen::MatrixXd> matrix() const { return P_.topLeftCorner(size_, size_); }
  /// For those who correct it: must stay symmetric to the last bit.
  Eigen::Ref<Eigen::MatrixXd> matrix() { return P_.topLeftCorner(size_, size_); }
  auto body() const { return P_.topLeftCorner<body::kSize, body::kSize>(); }

  /// Body block and calibration priors; no clones, no landmarks.
  void reset(const BodyCovariance& P0, const CalibrationOptions& priors) {
    P_.setZero();
    size_ = layout_.size(0);
    P_.topLeftCorner<body::kSize, body::kSize>() = 0.5 * (P0 + P0.transpose());
    const auto set = [this](int at, int length, double sigma) {
      P_.diagonal().segment(at, length).setConstant(sigma * sigma);
    };
    if (layout_.has_extrinsics()) {
      set(layout_.extrinsics(), 3, priors.rotation_sigma);
      set(layout_.extrinsics() + 3, 3, priors.translation_sigma);
    }
    if (layout_.has_radar_errors()) {
      set(layout_.radar_errors() + RadarErrors::kDopplerScale, 1, priors.doppler_scale_sigma);
      set(layout_.radar_errors() + RadarErrors::kElevation, 1, priors.elevation_bias_sigma);
    }
    if (layout_.has_time_offset()) set(layout_.time_offset(), 1, priors.time_offset_sigma);
  }

  void propagate(const Matrix15d& phi, const Matrix15d& noise) {  // (E1)
    constexpr int kBody = body::kSize;
    const int rest = size_ - kBody;
    const Matrix15d propagated = congruence(phi, P_.topLeftCorner<kBody, kBody>()) + noise;
    P_.topLeftCorner<kBody, kBody>() = 0.5 * (propagated + propagated.transpose());
    auto cross = scratch_.leftCols(rest);
    cross.noalias() = phi * P_.block(0, kBody, kBody, rest);
    P_.block(0, kBody, kBody, rest) = cross;
    P_.block(kBody, 0, rest, kBody) = cross.transpose();
  }

  /// The velocity turns out to be uncertain by `variance` [m^2/s^2] per axis since `duration` [s].
  void reopen_velocity(double variance, double duration) {  // (E3)
    for (int i = 0; i < 3; ++i) {
      const int p = body::kPosition + i;
      const int v = body::kVelocity + i;
      P_(v, v) += variance;
      P_(p, v) += duration * variance;
      P_(v, p) += duration * variance;
      P_(p, p) += duration * duration * variance;
    }
  }

  /// The pose in clone `slot` becomes the one the rows say.
  void assign_clone(int slot, const std::array<LinearRow, 6>& rows) {
    assign<6>(layout_.clone(slot), rows, Eigen::Matrix<double, 6, 6>::Zero());
  }
  /// Appends landmark `index` (the number of landmarks so far).
  /// @param noise covariance of the landmark given the state [m^2]
  void add_landmark([[maybe_unused]] int index, const std::array<LinearRow, 3>& rows,
                    const Matrix3d& noise) {
    RIO_ASSERT(layout_.landmark(index) == size_ && size_ + 3 <= layout_.capacity());
    size_ += 3;
    assign<3>(size_ - 3, rows, noise);
  }
  /// Landmark `index` leaves; the last one takes its place.
  void remove_landmark(int index) {
    const int at = layout_.landmark(index);
    const int last = size_ - 3;
    if (at != last) {
      P_.block(at, 0, 3, size_) = P_.block(last, 0, 3, size_);
      P_.block(0, at, size_, 3) = P_.block(0, last, size_, 3);
    }
    size_ = last;
  }
  /// Every landmark walks by this variance per axis [m^2].
  void add_landmark_noise(double variance) {
    P_.diagonal().segment(layout_.landmark(0), size_ - layout_.landmark(0)).array() += variance;
  }

  /// h_a P h_b^T.
  double product(const LinearRow& a, const LinearRow& b) const {
    double sum = 0.0;
    a.for_each_segment([&](int column_a, const double* h_a, int length_a) {
      b.for_each_segment([&](int column_b, const double* h_b, int length_b) {
        for (int j = 0; j < length_b; ++j) {
          const double* p = &P_(column_a, column_b + j);
          double dot = 0.0;
          for (int i = 0; i < length_a; ++i) dot += h_a[i] * p[i];
          sum += dot * h_b[j];
        }
      });
    });
    return sum;
  }
  /// H P H^T of a few rows.
  template <std::size_t kRows>
  auto covariance_of(const std::array<LinearRow, kRows>& rows) const {
    constexpr int kSize = static_cast<int>(kRows);
    Eigen::Matrix<double, kSize, kSize> S;
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j <= i; ++j) {
        S(i, j) = S(j, i) =
            product(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
      }
    }
    return S;
  }

  /// Innovation covariance of a block, at most Gate::kMaxDof rows.
  using BlockMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Gate::kMaxDof, Gate::kMaxDof>;
  void innovation_covariance(const RowBatch& batch, const RowBlock& block, BlockMatrix* S) const {
    const auto m = static_cast<Eigen::Index>(block.count);
    S->resize(m, m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const LinearRow& row = batch.rows()[block.first + static_cast<std::size_t>(i)];
      (*S)(i, i) = product(row, row) + row.variance;
      for (Eigen::Index j = 0; j < i; ++j) {
        const LinearRow& other = batch.rows()[block.first + static_cast<std::size_t>(j)];
        (*S)(i, j) = (*S)(j, i) = product(row, other) + block.shared_variance;
      }
    }
  }

 private:
  /// (E2) for the block at column `at`, which none of the rows touches.
  template <int kRows>
  void assign(int at, const std::array<LinearRow, static_cast<std::size_t>(kRows)>& rows,
              const Eigen::Matrix<double, kRows, kRows>& noise) {
    auto JP = scratch_.topLeftCorner(kRows, size_);
    JP.setZero();
    for (int i = 0; i < kRows; ++i) {
      rows[static_cast<std::size_t>(i)].for_each_segment(
          [&](int column, const double* h, int length) {
            for (int k = 0; k < length; ++k) JP.row(i) += h[k] * P_.row(column + k).head(size_);
          });
    }
    P_.block(at, 0, kRows, size_) = JP;
    P_.block(0, at, size_, kRows) = JP.transpose();
    for (int i = 0; i < kRows; ++i) {
      for (int j = 0; j <= i; ++j) {
        double own = noise(i, j);
        rows[static_cast<std::size_t>(j)].for_each_segment(
            [&](int column, const double* h, int length) {
              for (int k = 0; k < length; ++k) own += JP(i, column + k) * h[k];
            });
        P_(at + i, at + j) = P_(at + j, at + i) = own;
      }
    }
  }

  Layout layout_;
  Eigen::MatrixXd P_;
  Eigen::MatrixXd scratch_;
  int size_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The covariance P of the whole error state: start, propagation, blocks that enter and leave.
// Corrections are in ekf/panel_update.hpp, re-expression in ekf/reexpression.hpp.
//
// (E1) propagate: P_bb <- Phi P_bb Phi^T + Q, P_bx <- Phi P_bx              (ICRA 2023, eq. 7)
// (E2) assign:    a block becomes J x + n: P_kk = J P J^T + N, P_kx = J P    (ibid., eq. 5, 10, 11)
// (E3) re-open:   P <- P + G V G^T, G = [tau I; I] on position and velocity
// (E4) velocity measured: P <- P - P_v^T S^-1 P_v, S = P_vv + N, dx = P_v^T S^-1 r
// (E5) forget:    information i, that a parameter c at `value` is zero, is taken back:
//                 P <- P + P_c^T P_c / (1 / i - P_cc), dx = P_c^T value / (1 / i - P_cc)
// ICRA 2023 is Michalczyk et al., ICRA 2023. Nothing here allocates after construction. Clones make
// P singular by design: it is never factorised.
#pragma once

#include <Eigen/Core>
#include <array>

#include "rio/options.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

class Covariance {
 public:
  explicit Covariance(const Layout& layout);

  int size() const { return size_; }
  /// The whole covariance, symmetric to the last bit.
  Eigen::Ref<const Eigen::MatrixXd> matrix() const { return P_.topLeftCorner(size_, size_); }
  /// For those who correct it: must stay symmetric to the last bit.
  Eigen::Ref<Eigen::MatrixXd> matrix() { return P_.topLeftCorner(size_, size_); }
  auto body() const { return P_.topLeftCorner<body::kSize, body::kSize>(); }

  /// Body block and the priors of calibration and auxiliary states; no clones, no landmarks.
  void reset(const BodyCovariance& P0, const CalibrationOptions& priors,
             const AuxiliaryStates& auxiliary = {});

  /// (E1)
  /// @param phi its rows of the biases are those of the identity
  void propagate(const Matrix15d& phi, const Matrix15d& noise);

  /// The velocity turns out to be uncertain by `variance` [m^2/s^2] per axis since `duration` [s].
  void reopen_velocity(double variance, double duration);

  /// Three elements of the state from `at` on turn out to be uncertain by `variance` per axis.
  void inflate(int at, double variance) { inflate(at, 3, variance); }

  /// Same along one axis alone; its length is a sigma.
  void inflate_along(int at, const Vector3d& axis);

  /// (E4). The result corrects the state.
  /// @param residual velocity measured minus estimated [m/s], axes of W
  void measure_velocity(const Vector3d& residual_W, const Matrix3d& noise_W, Eigen::VectorXd* dx);

  /// (E5). The result corrects the state.
  void forget(int column, double value, double information, Eigen::VectorXd* dx);

  /// The pose in clone `slot` becomes the one the rows say.
  void assign_clone(int slot, const std::array<LinearRow, 6>& rows);
  /// Appends landmark `index` (the number of landmarks so far).
  /// @param noise covariance of the landmark given the state [m^2]
  void add_landmark([[maybe_unused]] int index, const std::array<LinearRow, 3>& rows,
                    const Matrix3d& noise);
  /// Landmark `index` leaves; the last one takes its place.
  void remove_landmark(int index);
  /// Every landmark walks by this variance per axis [m^2].
  void add_landmark_noise(double variance) {
    inflate(layout_.landmark(0), size_ - layout_.landmark(0), variance);
  }

  /// The auxiliary states walk for so long [s].
  void add_auxiliary_noise(const AuxiliaryStates& states, double seconds);

  /// h_a P h_b^T.
  double product(const LinearRow& a, const LinearRow& b) const;

 private:
  void inflate(int at, int count, double variance) {
    for (int i = at; i < at + count; ++i) P_(i, i) += variance;
  }

  /// (E2) for the block at column `at`, which none of the rows touches.
  template <int kRows>
  void assign(int at, const std::array<LinearRow, static_cast<std::size_t>(kRows)>& rows,
              const Eigen::Matrix<double, kRows, kRows>& noise);

  Layout layout_;
  Eigen::MatrixXd P_;
  Eigen::MatrixXd scratch_;
  int size_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The covariance P of the whole error state: initialisation, propagation, stochastic cloning,
// landmark augmentation and marginalisation, inflation. The update is in ekf/panel_update.hpp,
// re-expression in ekf/reexpression.hpp.
//
// (E1) propagate: P_bb <- Phi P_bb Phi^T + Q, P_bx <- Phi P_bx              (ICRA 2023, eq. 7)
// (E2) assign:    a clone, a landmark or a late state is J x + n: P_kk = J P J^T + N, P_kx = J P
//                                                                      (ibid., eq. 5, 10, 11)
// (E3) inflate:   P <- P + G V G^T, G = [tau I; I] on position and velocity
// (E4) velocity measured: P <- P - P_v^T S^-1 P_v, S = P_vv + N, dx = P_v^T S^-1 r
// ICRA 2023 is Michalczyk et al., ICRA 2023. Nothing here allocates after construction. Clones make
// P singular by design: it is never factorised.
#pragma once

#include <Eigen/Core>
#include <array>
#include <initializer_list>

#include "rio/propagate/strapdown.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

class Covariance {
 public:
  explicit Covariance(const Layout& layout);

  int size() const { return size_; }
  /// P, size() square, symmetric to the last bit.
  Eigen::Ref<const Eigen::MatrixXd> matrix() const { return P_.topLeftCorner(size_, size_); }
  /// For updates, which must leave it symmetric to the last bit.
  Eigen::Ref<Eigen::MatrixXd> matrix() { return P_.topLeftCorner(size_, size_); }
  auto body() const { return P_.topLeftCorner<body::kSize, body::kSize>(); }

  /// Body block and the prior variances of the parameters; no clones, no landmarks.
  void reset(const BodyCovariance& P0, const Eigen::VectorXd& parameters);

  /// (E1)
  /// @param phi transition whose bias rows are those of the identity
  void propagate(const Matrix15d& phi, const Matrix15d& noise);

  /// (E3): inflates the velocity by `variance` [m^2/s^2] per axis, constant for `duration` [s].
  void inflate_velocity(double variance, double duration);

  /// Inflates three elements of the state from `at` on by `variance` per axis.
  void inflate(int at, double variance) { P_.diagonal().segment<3>(at).array() += variance; }

  /// Same along one axis only, whose length is the sigma added.
  void inflate_along(int at, const Vector3d& axis) {
    P_.block<3, 3>(at, at) += axis * axis.transpose();
  }

  /// (E4). dx is the correction of the state.
  /// @param residual_W measured minus estimated velocity [m/s]
  void measure_velocity(const Vector3d& residual_W, const Matrix3d& noise_W, Eigen::VectorXd* dx);

  /// Stochastic cloning (E2): clone `slot` becomes the pose error given by the rows.
  void assign_clone(int slot, const std::array<LinearRow, 6>& rows);
  /// Landmark augmentation (E2): appends landmark `index`, the number of landmarks so far.
  /// @param noise covariance of the landmark given the state [m^2]
  void add_landmark([[maybe_unused]] int index, const std::array<LinearRow, 3>& rows,
                    const Matrix3d& noise);
  /// Marginalises landmark `index`; the last one takes its place.
  void remove_landmark(int index);
  /// Random walk of a landmark: adds these variances along the axes of W [m^2].
  void add_landmark_noise(int landmark, const Vector3d& variances) {
    P_.diagonal().segment<3>(layout_.landmark(landmark)) += variances;
  }

  /// Replaces parts of the state, each of three columns from `at[i]` on, by ones with this joint
  /// covariance and independent of the rest.
  void replace(std::initializer_list<int> at, const Eigen::Ref<const Eigen::MatrixXd>& covariance);

  /// (E2) for parameters from column `at` on, which were independent of all.
  /// @param by_body J, by the body state
  /// @param noise N
  void assign_parameters(int at, const Eigen::Ref<const Eigen::MatrixXd>& by_body,
                         const Eigen::Ref<const Eigen::MatrixXd>& noise);

  /// Random walk of the parameters over `seconds`.
  /// @param walk ParameterNoise::walk
  void add_parameter_noise(const Eigen::VectorXd& walk, double seconds) {
    P_.diagonal().segment(body::kSize, walk.size()) += seconds * walk;
  }

  /// h_a P h_b^T.
  double product(const LinearRow& a, const LinearRow& b) const;
  /// h P e, e the unit vector of one column of the error state.
  double product(const LinearRow& row, int column) const;

 private:
  /// (E2) for the block at column `at`, which the rows must not touch.
  template <int kRows>
  void assign(int at, const std::array<LinearRow, static_cast<std::size_t>(kRows)>& rows,
              const Eigen::Matrix<double, kRows, kRows>& noise);

  Layout layout_;
  Eigen::MatrixXd P_;
  Eigen::MatrixXd scratch_;
  int size_;
};

}  // namespace rio

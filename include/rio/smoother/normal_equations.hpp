// SPDX-License-Identifier: BSD-3-Clause
// The linear system of the sliding-window smoother: H dx = g over
//   [state 0 (oldest) | state 1 | .. | state n-1 (newest) | border: calibration and landmarks]
//
// (E1) H = sum w h^T h / variance + sum J^T J + A,  g = sum w h^T r / variance - sum J^T r + a
// (E2) H + damping diag(H) = L L^T                                             (Marquardt 1963)
// (E3) W = L_i0,  A = H_ii - W W^T,  a = g_i - W L_00^-1 g_0, i: all unknowns but those of state 0;
//      the Schur complement that eliminates state 0        (Michalczyk et al., IROS 2024, eq. 9-10)
// (E4) P_tt = (L_tt L_tt^T)^-1, t: newest state and border, which come last
//
// Elimination in the order of time is marginalisation, so that solving and marginalising are the
// same operation. Fill-in stays inside the envelope (George and Liu 1981, ch. 4): state i is
// coupled with the states up to reach(i); a measurement that touches the states [lowest, highest]
// gives each of them but the last the reach `highest`. The cost follows the envelope: with only IMU
// factors between the states, reach(i) = i + 1. The border is dense.
//
// Nothing allocates after construction. Results are written to the leading part of matrices that
// the caller provides, which must be large enough.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "rio/core/assert.hpp"
#include "rio/smoother/block_cholesky.hpp"
#include "rio/types.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

class NormalEquations {
 public:
  static constexpr int kState = body::kSize;
  using BetweenJacobian = Eigen::Matrix<double, kState, 2 * kState>;
  using StateVector = Eigen::Matrix<double, kState, 1>;

  NormalEquations(int max_states, int max_border);

  int states() const { return states_; }
  int border() const { return border_; }
  int size() const { return border_column() + border_; }
  int tail_size() const { return kState + border_; }
  int capacity() const { return column(max_states_) + max_border_; }
  static int column(int state) { return kState * state; }
  int border_column() const { return column(states_); }
  /// The highest state that `state` is coupled with, fill included.
  int reach(int state) const { return reach_[static_cast<std::size_t>(state)]; }
  /// Lower triangle of H; the upper one is not used.
  Eigen::Ref<const Eigen::MatrixXd> H() const { return H_.topLeftCorner(size(), size()); }
  Eigen::Ref<const Eigen::VectorXd> g() const { return g_.head(size()); }

  /// Empties the system. The factor is kept if the size is the same.
  void clear(int states, int border);

  /// Adds a measurement r = h dx + n.
  void add(const LinearRow& row, double weight = 1.0);

  /// Adds the information A, lower triangle, and vector g of state `state` and the border.
  /// @param columns of the unknowns, ascending; -1 = not estimated
  template <int kSize>
  void add(int state, const std::array<int, static_cast<std::size_t>(kSize)>& columns,
           const Eigen::Matrix<double, kSize, kSize>& A, const Eigen::Matrix<double, kSize, 1>& g) {
    couple(state, state);
    for (int j = 0; j < kSize; ++j) {
      const int to = columns[static_cast<std::size_t>(j)];
      if (to < 0) continue;
      touch(to, 1, state);
      g_[to] += g[j];
      for (int i = j; i < kSize; ++i) {
        const int row = columns[static_cast<std::size_t>(i)];
        if (row >= 0) H_(row, to) += A(i, j);
      }
    }
  }

  /// Adds the information A and vector g of the unknowns of the border from `at` on, coupled by C
  /// with those of `columns` before them, of state `state` or the border.
  template <int kOwn, int kSize>
  void add_coupled(int state, int at,
                   const std::array<int, static_cast<std::size_t>(kSize)>& columns,
                   const Eigen::Matrix<double, kOwn, kOwn>& A,
                   const Eigen::Matrix<double, kOwn, kSize>& C,
                   const Eigen::Matrix<double, kOwn, 1>& g) {
    touch(at, kOwn, state);
    H_.block<kOwn, kOwn>(at, at) += A;
    g_.segment<kOwn>(at) += g;
    for (int j = 0; j < kSize; ++j) {
      const int to = columns[static_cast<std::size_t>(j)];
      if (to >= 0) H_.block<kOwn, 1>(at, to) += C.col(j);
    }
  }

  /// Adds a whitened residual r + J dx of the states [state, state + 1].
  void add_between(int state, const BetweenJacobian& J, const StateVector& r);

  /// Adds information A and vector g over [states 0..leading_states-1 | first part of the border],
  /// as from eliminate_oldest(). Only the lower triangle of A is read.
  void add_quadratic(int leading_states, const Eigen::Ref<const Eigen::MatrixXd>& A,
                     const Eigen::Ref<const Eigen::VectorXd>& g);

  /// Computes L of (E2); H is kept, for another attempt with more damping. False if the damped H is
  /// not positive definite, e.g. because of an unknown without measurement: damping is relative.
  bool factorise(double damping = 0.0) {
    return factor_.factorise(H(), reach_, border_reach_, damping);
  }

  /// Solves for dx with the current factor, damping included: if the system has been rebuilt since
  /// factorise(), a step of the simplified Newton method. Precondition: factorise() was true for a
  /// system of this size.
  void solve(Eigen::VectorXd* dx) const;

  /// Covariance of [newest state | border] (E4), tail_size() square and exactly symmetric. False
  /// unless the last factorise() was without damping and true.
  bool tail_covariance(Eigen::MatrixXd* P);

  /// Marginalises state 0 of the undamped system by the Schur complement (E3): information and
  /// vector over [states 1..leading | border]. `leading` is the highest state that a measurement
  /// touches: if only those of state 0 were added, [1..leading | border] is its Markov blanket. A
  /// is exactly symmetric, column(leading) + border() square. The factor L is kept. False if the
  /// information of state 0 is not positive definite.
  bool eliminate_oldest(int* leading_states, Eigen::MatrixXd* A, Eigen::VectorXd* g);

 private:
  /// Records that one measurement touches the states `lowest` to `highest`.
  void couple(int lowest, int highest);

  /// Records that a measurement of states up to `state` touches unknowns of the border.
  void touch(int column, int length, int state) {
    for (int i = column - border_column(); i < column + length - border_column(); ++i) {
      if (i < 0) continue;
      int& reach = border_reach_[static_cast<std::size_t>(i)];
      reach = std::max(reach, state);
    }
  }

  int max_states_;
  int max_border_;
  int states_ = 0;
  int border_ = 0;
  int highest_ = -1;  ///< the highest state that a measurement touches
  std::vector<int> reach_;
  std::vector<int> border_reach_;
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
  Eigen::MatrixXd W_;
  EnvelopeFactor factor_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The linear system of the sliding-window smoother: H dx = g over
//   [state 0 (oldest) | state 1 | .. | state n-1 (newest) | border: calibration and landmarks]
//
// (E1) H = sum w h^T h / variance + sum J^T J + A,  g = sum w h^T r / variance - sum J^T r + a
// (E2) H + damping diag(H) = L L^T                                             (Marquardt 1963)
// (E3) W = L_i0,  A = H_ii - W W^T,  a = g_i - W L_00^-1 g_0, i: all unknowns but those of state 0;
//      the Schur complement that eliminates state 0        (Michalczyk et al., IROS 2024, eq. 9-10)
// (E4) P_tt = (L_tt L_tt^T)^-1, t: newest state and border, which stand last
//
// Elimination in the order of time is marginalisation, so that solving and marginalising are the
// same operation. L fills in only inside the envelope (George and Liu 1981, ch. 4): state i is
// coupled with the states up to reach(i), where an interval [lowest, highest] of states that one
// measurement touches gives each of them but the last the reach `highest`. The cost follows the
// envelope: with nothing but the IMU between the states reach(i) = i + 1. The border is dense.
//
// Nothing allocates after construction. Results are written to the leading part of matrices that
// the caller provides, large enough.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
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

  NormalEquations(int max_states, int max_border)
      : max_states_(max_states),
        max_border_(max_border),
        H_(Eigen::MatrixXd::Zero(capacity(), capacity())),
        g_(Eigen::VectorXd::Zero(capacity())),
        W_(Eigen::MatrixXd::Zero(capacity(), kState)),
        factor_(max_states, max_border) {
    RIO_ASSERT(max_states > 0 && max_border >= 0);
    reach_.reserve(static_cast<std::size_t>(max_states));
  }

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

  /// An empty system. The factor of one of the same size stays.
  void clear(int states, int border) {
    RIO_ASSERT(states > 0 && states <= max_states_ && border >= 0 && border <= max_border_);
    if (states != states_ || border != border_) factor_.clear();
    states_ = states;
    border_ = border;
    highest_ = -1;
    reach_.resize(static_cast<std::size_t>(states));
    std::iota(reach_.begin(), reach_.end(), 0);
    for (int s = 0; s < states_; ++s) {  // the lower triangle
      H_.block(column(s), column(s), size() - column(s), kState).setZero();
    }
    H_.block(border_column(), border_column(), border_, border_).setZero();
    g_.head(size()).setZero();
  }

  /// A measurement r = h dx + n.
  void add(const LinearRow& row, double weight = 1.0) {
    RIO_ASSERT(row.variance > 0.0);
    const double information = weight / row.variance;
    int lowest = states_;
    int highest = -1;
    row.for_each_segment([&](int column_a, const double* h_a, int length_a) {
      RIO_ASSERT(column_a >= 0 && column_a + length_a <= size());
      if (column_a < border_column()) {
        lowest = std::min(lowest, column_a / kState);
        highest = std::max(highest, (column_a + length_a - 1) / kState);
      }
      for (int i = 0; i < length_a; ++i) g_[column_a + i] += information * row.residual * h_a[i];
      row.for_each_segment([&](int column_b, const double* h_b, int length_b) {
        for (int j = 0; j < length_b; ++j) {
          double* h = &H_(column_a, column_b + j);
          const double scaled = information * h_b[j];
          const int diagonal = column_b + j - column_a;  // the lower triangle begins there
          for (int i = std::max(0, diagonal); i < length_a; ++i) h[i] += scaled * h_a[i];
        }
      });
    });
    if (highest >= 0) couple(lowest, highest);
  }

  /// Information A, lower triangle, and vector g of state `state` and the border.
  /// @param columns of the unknowns, ascending; -1 = not estimated
  template <int kSize>
  void add(int state, const std::array<int, static_cast<std::size_t>(kSize)>& columns,
           const Eigen::Matrix<double, kSize, kSize>& A, const Eigen::Matrix<double, kSize, 1>& g) {
    couple(state, state);
    for (int j = 0; j < kSize; ++j) {
      const int to = columns[static_cast<std::size_t>(j)];
      if (to < 0) continue;
      g_[to] += g[j];
      for (int i = j; i < kSize; ++i) {
        const int row = columns[static_cast<std::size_t>(i)];
        if (row >= 0) H_(row, to) += A(i, j);
      }
    }
  }

  /// Information A of the unknowns from `at` on, coupled by C with those of `columns` before them.
  template <int kOwn, int kSize>
  void add_coupled(int at, const std::array<int, static_cast<std::size_t>(kSize)>& columns,
                   const Eigen::Matrix<double, kOwn, kOwn>& A,
                   const Eigen::Matrix<double, kOwn, kSize>& C,
                   const Eigen::Matrix<double, kOwn, 1>& g) {
    H_.block<kOwn, kOwn>(at, at) += A;
    g_.segment<kOwn>(at) += g;
    for (int j = 0; j < kSize; ++j) {
      const int to = columns[static_cast<std::size_t>(j)];
      if (to >= 0) H_.block<kOwn, 1>(at, to) += C.col(j);
    }
  }

  /// A whitened residual r + J dx of the states [state, state + 1].
  void add_between(int state, const BetweenJacobian& J, const StateVector& r) {
    RIO_ASSERT(state >= 0 && state + 1 < states_);
    couple(state, state + 1);
    H_.block<2 * kState, 2 * kState>(column(state), column(state))
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(J.transpose());
    g_.segment<2 * kState>(column(state)).noalias() -= J.transpose() * r;
  }

  /// Information A and vector g over [states 0..leading_states-1 | first part of the border], as
  /// eliminate_oldest() gives them. Only the lower triangle of A is read.
  void add_quadratic(int leading_states, const Eigen::Ref<const Eigen::MatrixXd>& A,
                     const Eigen::Ref<const Eigen::VectorXd>& g) {
    const Eigen::Index m = column(leading_states);
    const Eigen::Index rest = A.rows() - m;
    const Eigen::Index at = border_column();
    RIO_ASSERT(leading_states <= states_ && rest >= 0 && rest <= border_);
    RIO_ASSERT(A.cols() == A.rows() && g.size() == A.rows());
    if (leading_states > 0) couple(0, leading_states - 1);
    for (Eigen::Index c = 0; c < m; ++c) {
      H_.col(c).segment(c, m - c) += A.col(c).segment(c, m - c);
      H_.col(c).segment(at, rest) += A.col(c).tail(rest);
    }
    for (Eigen::Index c = 0; c < rest; ++c) {
      H_.col(at + c).segment(at + c, rest - c) += A.col(m + c).tail(rest - c);
    }
    g_.head(m) += g.head(m);
    g_.segment(at, rest) += g.tail(rest);
  }

  /// L of (E2); H stays, for another try with more damping. False if the damped H is not positive
  /// definite. An unknown that nothing touches makes it so: damping is relative.
  bool factorise(double damping = 0.0) { return factor_.factorise(H(), reach_, damping); }

  /// dx by the factor as it is, damping included: of the system that was factorised, or, if it has
  /// been built anew since, a step of the simplified Newton method. Precondition: factorise() was
  /// true for a system of this size.
  void solve(Eigen::VectorXd* dx) const {
    RIO_ASSERT(dx->size() >= size());
    dx->head(size()) = g();
    factor_.solve(dx->head(size()));
  }

  /// Covariance of [newest state | border] (E4), tail_size() square and exactly symmetric. False
  /// unless the last factorise() was without damping and true.
  bool tail_covariance(Eigen::MatrixXd* P) {
    RIO_ASSERT(P->rows() >= tail_size() && P->cols() >= tail_size());
    return factor_.tail_inverse(P->topLeftCorner(tail_size(), tail_size()));
  }

  /// Eliminates state 0 of the undamped system (E3): what the rest of the system knows, over
  /// [states 1..leading | border]. `leading` is the highest state that anything touches: if only
  /// the measurements of state 0 were added, that is its Markov blanket. A is exactly symmetric,
  /// column(leading) + border() square. The factor L stays. False if the information of state 0 is
  /// not positive definite.
  bool eliminate_oldest(int* leading_states, Eigen::MatrixXd* A, Eigen::VectorXd* g) {
    Eigen::Matrix<double, kState, kState> oldest = H_.topLeftCorner<kState, kState>();
    const StateVector floor = cholesky::kPivotTolerance * oldest.diagonal();
    if (!cholesky::factorise(oldest, floor)) return false;
    StateVector y = g_.head<kState>();
    oldest.triangularView<Eigen::Lower>().solveInPlace(y);
    *leading_states = std::max(highest_, 0);
    const Eigen::Index m = column(*leading_states);
    const Eigen::Index size = m + border_;
    const Eigen::Index at = border_column();
    RIO_ASSERT(A->rows() >= size && A->cols() >= size && g->size() >= size);
    auto W = W_.topRows(size);
    W.topRows(m) = H_.block(kState, 0, m, kState);
    W.bottomRows(border_) = H_.block(at, 0, border_, kState);
    cholesky::divide_right(oldest, W);
    auto rest = A->topLeftCorner(size, size);
    rest.topLeftCorner(m, m) = H_.block(kState, kState, m, m);
    rest.bottomLeftCorner(border_, m) = H_.block(at, kState, border_, m);
    rest.bottomRightCorner(border_, border_) = H_.block(at, at, border_, border_);
    rest.selfadjointView<Eigen::Lower>().rankUpdate(W, -1.0);
    cholesky::mirror_lower(rest);
    g->head(m) = g_.segment(kState, m);
    g->segment(m, border_) = g_.segment(at, border_);
    g->head(size).noalias() -= W * y;
    return true;
  }

 private:
  /// One measurement touches states from `lowest` to `highest`.
  void couple(int lowest, int highest) {
    for (int s = lowest; s < highest; ++s) {
      int& reach = reach_[static_cast<std::size_t>(s)];
      reach = std::max(reach, highest);
    }
    highest_ = std::max(highest_, highest);
  }

  int max_states_;
  int max_border_;
  int states_ = 0;
  int border_ = 0;
  int highest_ = -1;  ///< the highest state that anything touches
  std::vector<int> reach_;
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
  Eigen::MatrixXd W_;
  EnvelopeFactor factor_;
};

}  // namespace rio

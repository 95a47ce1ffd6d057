// SPDX-License-Identifier: BSD-3-Clause
// Cholesky factorisation of a symmetric matrix with an envelope of state blocks and a dense border,
//   [state 0 | state 1 | .. | state n-1 | border],
// and the dense steps on blocks that it consists of.
//
// (E1) A = L L^T
// (E2) X <- X L^-T
// (E3) (L L^T)^-1 = X^T X, X = L^-1                    (Golub and Van Loan 2013, ch. 3.1 and 4.2)
// (E4) L_kk L_kk^T = H_kk, L_ik = H_ik L_kk^-T, H_ij <- H_ij - L_ik L_jk^T, i >= j > k, block by
//      block; state k has blocks up to the state reach(k) and in the border, no others
//                                                       (George and Liu 1981, ch. 4)
//
// Only the lower triangle of a symmetric matrix is read and written. No product is deeper than
// kPanel, so that the packing buffers of Eigen stay on the stack: nothing allocates after
// construction.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "rio/core/assert.hpp"
#include "rio/types.hpp"

namespace rio {

namespace cholesky {

constexpr int kPanel = 32;  ///< largest depth of a product

/// A pivot below this share of its diagonal element is round-off: twice what singular chains of 12
/// states leave. A badly scaled singular matrix may leave more and is then accepted.
constexpr double kPivotTolerance = 32.0 * std::numeric_limits<double>::epsilon();

/// Lower triangle of A <- L (E1). False if A is not positive definite or not finite.
/// @param floor the square of each pivot must be above this
inline bool factorise(Eigen::Ref<Eigen::MatrixXd> A,
                      const Eigen::Ref<const Eigen::VectorXd>& floor) {
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(A);
  return llt.info() == Eigen::Success &&
         (A.diagonal().array().square() > floor.array()).all();  // false for NaN
}

/// X <- X L^-T (E2), column by column.
/// @param L lower triangular, at most kPanel wide
inline void divide_right(const Eigen::Ref<const Eigen::MatrixXd>& L,
                         Eigen::Ref<Eigen::MatrixXd> X) {
  RIO_ASSERT(L.cols() <= kPanel && L.cols() == X.cols());
  Eigen::Matrix<double, kPanel, 1> l;
  for (Eigen::Index k = 0; k < X.cols(); ++k) {
    l.head(k) = L.row(k).head(k).transpose();
    X.col(k).noalias() -= X.leftCols(k) * l.head(k);
    X.col(k) *= 1.0 / L(k, k);
  }
}

/// Upper triangle <- lower triangle: symmetric to the last bit.
inline void mirror_lower(Eigen::Ref<Eigen::MatrixXd> A) {
  for (Eigen::Index c = 1; c < A.cols(); ++c) {
    for (Eigen::Index r = 0; r < c; ++r) A(r, c) = A(c, r);
  }
}

/// P <- (L L^T)^-1 (E3), both triangles.
/// @param X scratch of the size of L
inline void invert_product(const Eigen::Ref<const Eigen::MatrixXd>& L,
                           Eigen::Ref<Eigen::MatrixXd> X, Eigen::Ref<Eigen::MatrixXd> P) {
  const Eigen::Index size = L.rows();
  X.setIdentity();
  P.setZero();
  for (Eigen::Index first = 0; first < size; first += kPanel) {
    const Eigen::Index width = std::min<Eigen::Index>(kPanel, size - first);
    const Eigen::Index end = first + width;
    auto rows = X.block(first, 0, width, end);  // these rows of L X = I
    L.block(first, first, width, width).triangularView<Eigen::Lower>().solveInPlace(rows);
    X.block(end, 0, size - end, end).noalias() -= L.block(end, first, size - end, width) * rows;
    P.topLeftCorner(end, end).selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  mirror_lower(P);
}

}  // namespace cholesky

/// The factor L of H + damping diag(H).
class EnvelopeFactor {
 public:
  static constexpr int kState = body::kSize;

  EnvelopeFactor(int max_states, int max_border)
      : L_(Eigen::MatrixXd::Zero(kState * max_states + max_border,
                                 kState * max_states + max_border)),
        floor_(Eigen::VectorXd::Zero(L_.rows())),
        inverse_(Eigen::MatrixXd::Zero(kState + max_border, kState + max_border)) {
    reach_.reserve(static_cast<std::size_t>(max_states));
  }

  /// No factor.
  void clear() { valid_ = false; }

  /// (E4). False if the damped matrix is not positive definite.
  /// @param reach the last state with a block below each state; never less than that of the state
  ///   before, so that what is eliminated fills in nothing outside
  bool factorise(const Eigen::Ref<const Eigen::MatrixXd>& H, const std::vector<int>& reach,
                 double damping) {
    RIO_ASSERT(reach.size() <= reach_.capacity() && H.rows() <= L_.rows());
    valid_ = false;
    damping_ = damping;
    reach_ = reach;
    states_ = static_cast<int>(reach.size());
    border_ = static_cast<int>(H.rows()) - column(states_);
    copy_envelope(H);
    for (int s = 0; s < states_; ++s) {
      if (!factorise_state(s)) return false;
    }
    valid_ = border_ == 0 || factorise_border();
    return valid_;
  }

  /// x <- (L L^T)^-1 x. Precondition: the last factorise() was true.
  void solve(Eigen::Ref<Eigen::VectorXd> x) const {
    RIO_ASSERT(valid_ && x.size() == column(states_) + border_);
    auto border = x.tail(border_);
    const auto corner =
        L_.block(column(states_), column(states_), border_, border_).triangularView<Eigen::Lower>();
    for (int s = 0; s < states_; ++s) {
      auto own = x.segment<kState>(column(s));
      own_block(s).triangularView<Eigen::Lower>().solveInPlace(own);
      x.segment(column(s + 1), rows_below(s)).noalias() -= below(s) * own;
      border.noalias() -= in_border(s) * own;
    }
    corner.solveInPlace(border);
    corner.adjoint().solveInPlace(border);
    for (int s = states_ - 1; s >= 0; --s) {
      auto own = x.segment<kState>(column(s));
      own.noalias() -= in_border(s).transpose() * border;
      own.noalias() -= below(s).transpose() * x.segment(column(s + 1), rows_below(s));
      own_block(s).transpose().triangularView<Eigen::Upper>().solveInPlace(own);
    }
  }

  /// Inverse of H over [last state | border], both triangles: these stand last, so that their part
  /// of L is the factor of what is left when the other states are eliminated. False without a
  /// factor, or if it was damped.
  bool tail_inverse(const Eigen::Ref<Eigen::MatrixXd>& P) {
    if (!valid_ || damping_ != 0.0) return false;
    const Eigen::Index tail = kState + border_;
    const Eigen::Index at = column(states_ - 1);
    cholesky::invert_product(L_.block(at, at, tail, tail), inverse_.topLeftCorner(tail, tail), P);
    return true;
  }

 private:
  static constexpr int kStatesPerPanel = cholesky::kPanel / kState;
  using Square = Eigen::Block<const Eigen::MatrixXd, kState, kState>;
  using Column = Eigen::Block<const Eigen::MatrixXd, Eigen::Dynamic, kState>;

  static int column(int state) { return kState * state; }
  int rows_below(int s) const { return column(reach_[static_cast<std::size_t>(s)] - s); }
  // The blocks of the column of state s.
  Square own_block(int s) const { return {L_, column(s), column(s)}; }
  Column below(int s) const { return {L_, column(s + 1), column(s), rows_below(s), kState}; }
  Column in_border(int s) const { return {L_, column(states_), column(s), border_, kState}; }

  void copy_envelope(const Eigen::Ref<const Eigen::MatrixXd>& H) {
    for (int s = 0; s < states_; ++s) {
      const int c = column(s);
      const int rows = kState + rows_below(s);
      L_.block(c, c, rows, kState) = H.block(c, c, rows, kState);
      L_.block(column(states_), c, border_, kState) = H.block(column(states_), c, border_, kState);
    }
    const int at = column(states_);
    L_.block(at, at, border_, border_) = H.block(at, at, border_, border_);
    L_.diagonal().head(H.rows()) *= 1.0 + damping_;
    floor_.head(H.rows()) = cholesky::kPivotTolerance * L_.diagonal().head(H.rows());
  }

  /// The column of state s, and what it takes from the states after it. The corner of the border
  /// is left to factorise_border().
  bool factorise_state(int s) {
    const int c = column(s);
    const int next = column(s + 1);
    const int rows = rows_below(s);
    auto own = L_.block<kState, kState>(c, c);
    auto states = L_.block(next, c, rows, kState);
    auto border = L_.block(column(states_), c, border_, kState);
    if (!cholesky::factorise(own, floor_.segment<kState>(c))) return false;
    cholesky::divide_right(own, states);
    cholesky::divide_right(own, border);
    L_.block(next, next, rows, rows).selfadjointView<Eigen::Lower>().rankUpdate(states, -1.0);
    L_.block(column(states_), next, border_, rows).noalias() -= border * states.transpose();
    return true;
  }

  /// All states at once, as many at a time as a product may be deep: fewer passes over the corner.
  bool factorise_border() {
    const int at = column(states_);
    auto corner = L_.block(at, at, border_, border_);
    for (int s = 0; s < states_; s += kStatesPerPanel) {
      const int width = column(std::min(kStatesPerPanel, states_ - s));
      corner.selfadjointView<Eigen::Lower>().rankUpdate(L_.block(at, column(s), border_, width),
                                                        -1.0);
    }
    return cholesky::factorise(corner, floor_.segment(at, border_));
  }

  int states_ = 0;
  int border_ = 0;
  bool valid_ = false;
  double damping_ = 0.0;
  std::vector<int> reach_;
  Eigen::MatrixXd L_;
  Eigen::VectorXd floor_;
  Eigen::MatrixXd inverse_;
};

}  // namespace rio

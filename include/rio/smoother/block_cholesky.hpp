// SPDX-License-Identifier: BSD-3-Clause
// Cholesky factorisation of a symmetric matrix with an envelope of state blocks and a dense border,
//   [state 0 | state 1 | .. | state n-1 | border],
// and the dense operations on its blocks.
//
// (E1) A = L L^T
// (E2) X <- X L^-T
// (E3) (L L^T)^-1 = X^T X, X = L^-1                    (Golub and Van Loan 2013, ch. 3.1 and 4.2)
// (E4) L_kk L_kk^T = H_kk, L_ik = H_ik L_kk^-T, H_ij <- H_ij - L_ik L_jk^T, i >= j > k, block by
//      block; state k has blocks up to the state reach(k) and in the border, no others
//                                                       (George and Liu 1981, ch. 4)
//
// (E5) Most of the border, the landmarks out of view, is coupled with state 0 only: H_ds = 0 for
//      s > 0. Then L_ds = H_d0 Y_s with Y = [I 0 .. 0] L^-T, and H_d0 Z H_d0^T is subtracted from
//      the corner, Z = sum_s Y_s Y_s^T, at a cost independent of the number of states. Y is
//      computed as fifteen more rows of the border, coupled with state 0 by the identity.
//
// Only the lower triangle of a symmetric matrix is read and written. No product is deeper than
// kPanel, so that the packing buffers of Eigen stay on the stack: nothing allocates after
// construction.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "rio/core/assert.hpp"
#include "rio/types.hpp"

namespace rio {

namespace cholesky {

constexpr int kPanel = 32;  ///< largest depth of a product

/// A squared pivot below this share of its diagonal element is round-off: twice that of singular
/// chains of 12 states. A badly scaled singular matrix may have more and is then accepted.
constexpr double kPivotTolerance = 32.0 * std::numeric_limits<double>::epsilon();

/// Lower triangle of A <- L (E1). False if A is not positive definite or not finite.
/// @param floor the square of each pivot must be above this
bool factorise(Eigen::Ref<Eigen::MatrixXd> A, const Eigen::Ref<const Eigen::VectorXd>& floor);

/// X <- X L^-T (E2), column by column.
/// @param L lower triangular, at most kPanel wide
void divide_right(const Eigen::Ref<const Eigen::MatrixXd>& L, Eigen::Ref<Eigen::MatrixXd> X);

/// P <- (L L^T)^-1 (E3), both triangles.
/// @param X scratch of the size of L
void invert_product(const Eigen::Ref<const Eigen::MatrixXd>& L, Eigen::Ref<Eigen::MatrixXd> X,
                    Eigen::Ref<Eigen::MatrixXd> P);

}  // namespace cholesky

/// The factor L of H + damping diag(H).
class EnvelopeFactor {
 public:
  static constexpr int kState = body::kSize;

  EnvelopeFactor(int max_states, int max_border);

  /// Discards the factor.
  void clear() { valid_ = false; }

  /// (E4) (E5). False if the damped matrix is not positive definite.
  /// @param reach the last state with a block below each state; not decreasing, so that there is no
  ///   fill-in outside the envelope
  /// @param border_reach the last state that each unknown of the border is coupled with
  bool factorise(const Eigen::Ref<const Eigen::MatrixXd>& H, const std::vector<int>& reach,
                 const std::vector<int>& border_reach, double damping);

  /// x <- (L L^T)^-1 x. Precondition: the last factorise() was true.
  void solve(Eigen::Ref<Eigen::VectorXd> x) const;

  /// Marginal covariance of [last state | border], both triangles: these come last, so that their
  /// part of L is the factor of the Schur complement of the other states. False without a factor,
  /// or if it was damped.
  bool tail_inverse(const Eigen::Ref<Eigen::MatrixXd>& P);

 private:
  static constexpr int kStatesPerPanel = cholesky::kPanel / kState;
  using Square = Eigen::Block<const Eigen::MatrixXd, kState, kState>;
  using Column = Eigen::Block<const Eigen::MatrixXd, Eigen::Dynamic, kState>;

  static int column(int state) { return kState * state; }
  int rows_below(int s) const { return column(reach_[static_cast<std::size_t>(s)] - s); }
  // The order in L: states, the unknowns of the border coupled with state 0 only ("far"), its other
  // unknowns ("near"), the rows Y.
  int near() const { return border_ - far_; }
  int far_row() const { return column(states_); }
  int near_row() const { return far_row() + far_; }
  int last_rows() const { return near() + (far_ > 0 ? kState : 0); }
  // The blocks of the column of state s.
  Square own_block(int s) const { return {L_, column(s), column(s)}; }
  Column below(int s) const { return {L_, column(s + 1), column(s), rows_below(s), kState}; }
  Column last(int s) const { return {L_, near_row(), column(s), last_rows(), kState}; }
  /// H_d0, stored in place of L_d0.
  Column far_coupling() const { return {L_, far_row(), 0, far_, kState}; }

  /// Fills order_: far unknowns first.
  void order_border(const std::vector<int>& border_reach);

  /// Copies the blocks of H that factorise() reads, damped, and sets the floor of the pivots.
  void copy_envelope(const Eigen::Ref<const Eigen::MatrixXd>& H);

  /// Factorises the column of state s and subtracts it from the later states. The corner of the
  /// border is left to factorise_border().
  bool factorise_state(int s);

  /// Subtracts all states from the corner, kStatesPerPanel at a time, and factorises it.
  bool factorise_border();

  /// (E5): subtracts the products with the far unknowns from the corner.
  void subtract_far();

  int states_ = 0;
  int border_ = 0;
  bool valid_ = false;
  double damping_ = 0.0;
  std::vector<int> reach_;
  int far_ = 0;
  std::vector<int> order_;  ///< index in the border, by place in L
  Eigen::MatrixXd L_;
  Eigen::MatrixXd far_Z_;  ///< H_d0 Z
  Eigen::VectorXd floor_;
  Eigen::MatrixXd inverse_;
  Eigen::MatrixXd tail_;       ///< covariance in the order of L
  mutable Eigen::VectorXd x_;  ///< scratch of solve()
};

}  // namespace rio

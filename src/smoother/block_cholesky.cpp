// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/block_cholesky.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace rio {

namespace cholesky {

bool factorise(Eigen::Ref<Eigen::MatrixXd> A, const Eigen::Ref<const Eigen::VectorXd>& floor) {
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(A);
  return llt.info() == Eigen::Success &&
         (A.diagonal().array().square() > floor.array()).all();  // false for NaN
}

void divide_right(const Eigen::Ref<const Eigen::MatrixXd>& L, Eigen::Ref<Eigen::MatrixXd> X) {
  RIO_ASSERT(L.cols() <= kPanel && L.cols() == X.cols());
  Eigen::Matrix<double, kPanel, 1> l;
  for (Eigen::Index k = 0; k < X.cols(); ++k) {
    l.head(k) = L.row(k).head(k).transpose();
    X.col(k).noalias() -= X.leftCols(k) * l.head(k);
    X.col(k) *= 1.0 / L(k, k);
  }
}

void mirror_lower(Eigen::Ref<Eigen::MatrixXd> A) {
  for (Eigen::Index c = 1; c < A.cols(); ++c) {
    for (Eigen::Index r = 0; r < c; ++r) A(r, c) = A(c, r);
  }
}

void invert_product(const Eigen::Ref<const Eigen::MatrixXd>& L, Eigen::Ref<Eigen::MatrixXd> X,
                    Eigen::Ref<Eigen::MatrixXd> P) {
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

EnvelopeFactor::EnvelopeFactor(int max_states, int max_border)
    : L_(Eigen::MatrixXd::Zero(kState * max_states + max_border, kState * max_states + max_border)),
      floor_(Eigen::VectorXd::Zero(L_.rows())),
      inverse_(Eigen::MatrixXd::Zero(kState + max_border, kState + max_border)) {
  reach_.reserve(static_cast<std::size_t>(max_states));
}

bool EnvelopeFactor::factorise(const Eigen::Ref<const Eigen::MatrixXd>& H,
                               const std::vector<int>& reach, double damping) {
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

void EnvelopeFactor::solve(Eigen::Ref<Eigen::VectorXd> x) const {
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

bool EnvelopeFactor::tail_inverse(const Eigen::Ref<Eigen::MatrixXd>& P) {
  if (!valid_ || damping_ != 0.0) return false;
  const Eigen::Index tail = kState + border_;
  const Eigen::Index at = column(states_ - 1);
  cholesky::invert_product(L_.block(at, at, tail, tail), inverse_.topLeftCorner(tail, tail), P);
  return true;
}

void EnvelopeFactor::copy_envelope(const Eigen::Ref<const Eigen::MatrixXd>& H) {
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

bool EnvelopeFactor::factorise_state(int s) {
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

bool EnvelopeFactor::factorise_border() {
  const int at = column(states_);
  auto corner = L_.block(at, at, border_, border_);
  for (int s = 0; s < states_; s += kStatesPerPanel) {
    const int width = column(std::min(kStatesPerPanel, states_ - s));
    corner.selfadjointView<Eigen::Lower>().rankUpdate(L_.block(at, column(s), border_, width),
                                                      -1.0);
  }
  return cholesky::factorise(corner, floor_.segment(at, border_));
}

}  // namespace rio

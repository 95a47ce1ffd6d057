// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/block_cholesky.hpp"

#include <algorithm>

#include "rio/core/symmetric.hpp"

namespace rio {

namespace cholesky {

bool factorise(Eigen::Ref<Eigen::MatrixXd> A, const Eigen::Ref<const Eigen::VectorXd>& floor) {
  return factorise_in_place(A) &&
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
    : L_(Eigen::MatrixXd::Zero(kState * (max_states + 1) + max_border,
                               kState * (max_states + 1) + max_border)),
      far_Z_(Eigen::MatrixXd::Zero(max_border, kState)),
      floor_(Eigen::VectorXd::Zero(L_.rows())),
      inverse_(Eigen::MatrixXd::Zero(kState + max_border, kState + max_border)),
      tail_(inverse_),
      x_(floor_) {
  reach_.reserve(static_cast<std::size_t>(max_states));
  order_.reserve(static_cast<std::size_t>(max_border));
}

bool EnvelopeFactor::factorise(const Eigen::Ref<const Eigen::MatrixXd>& H,
                               const std::vector<int>& reach, const std::vector<int>& border_reach,
                               double damping) {
  RIO_ASSERT(reach.size() <= reach_.capacity() && border_reach.size() <= order_.capacity());
  valid_ = false;
  damping_ = damping;
  reach_ = reach;
  states_ = static_cast<int>(reach.size());
  border_ = static_cast<int>(border_reach.size());
  order_border(border_reach);
  copy_envelope(H);
  for (int s = 0; s < states_; ++s) {
    if (!factorise_state(s)) return false;
  }
  valid_ = border_ == 0 || factorise_border();
  return valid_;
}

void EnvelopeFactor::solve(Eigen::Ref<Eigen::VectorXd> x) const {
  RIO_ASSERT(valid_ && x.size() == column(states_) + border_);
  const int first = column(states_);
  auto border = x_.head(border_);
  auto last_x = x_.segment(far_, last_rows());  // near unknowns, then Y
  for (int i = 0; i < border_; ++i) border[i] = x[first + order_[static_cast<std::size_t>(i)]];
  auto y = x_.segment(border_, kState);
  y.setZero();
  const auto corner = L_.block(first, first, border_, border_).triangularView<Eigen::Lower>();
  for (int s = 0; s < states_; ++s) {
    auto own = x.segment<kState>(column(s));
    own_block(s).triangularView<Eigen::Lower>().solveInPlace(own);
    x.segment(column(s + 1), rows_below(s)).noalias() -= below(s) * own;
    last_x.noalias() -= last(s) * own;
  }
  border.head(far_).noalias() += far_coupling() * y;
  corner.solveInPlace(border);
  corner.adjoint().solveInPlace(border);
  y.noalias() = far_coupling().transpose() * border.head(far_);
  for (int s = states_ - 1; s >= 0; --s) {
    auto own = x.segment<kState>(column(s));
    own.noalias() -= last(s).transpose() * last_x;
    own.noalias() -= below(s).transpose() * x.segment(column(s + 1), rows_below(s));
    own_block(s).transpose().triangularView<Eigen::Upper>().solveInPlace(own);
  }
  for (int i = 0; i < border_; ++i) x[first + order_[static_cast<std::size_t>(i)]] = border[i];
}

bool EnvelopeFactor::tail_inverse(const Eigen::Ref<Eigen::MatrixXd>& P) {
  if (!valid_ || damping_ != 0.0) return false;
  const Eigen::Index tail = kState + border_;
  const int at = column(states_ - 1);
  // L_ds of the last state (a single state has no far unknowns)
  if (far_ > 0) {
    L_.block(far_row(), at, far_, kState).noalias() =
        far_coupling() * L_.block<kState, kState>(near_row() + near(), at);
  }
  auto permuted = tail_.topLeftCorner(tail, tail);
  cholesky::invert_product(L_.block(at, at, tail, tail), inverse_.topLeftCorner(tail, tail),
                           permuted);
  Eigen::Ref<Eigen::MatrixXd> out(P);
  const auto place = [this](Eigen::Index i) {
    return i < kState ? i : kState + order_[static_cast<std::size_t>(i - kState)];
  };
  for (Eigen::Index c = 0; c < tail; ++c) {
    double* column = &out(0, place(c));
    for (Eigen::Index r = 0; r < tail; ++r) column[place(r)] = permuted(r, c);
  }
  return true;
}

void EnvelopeFactor::order_border(const std::vector<int>& border_reach) {
  const auto is_far = [](int reach) { return reach <= 0; };
  far_ = static_cast<int>(std::count_if(border_reach.begin(), border_reach.end(), is_far));
  if (far_ <= kState || states_ == 1) far_ = 0;  // Y would cost as much
  order_.clear();
  for (const bool far : {true, false}) {
    for (int i = 0; i < border_; ++i) {
      if ((far_ > 0 && is_far(border_reach[static_cast<std::size_t>(i)])) == far)
        order_.push_back(i);
    }
  }
}

void EnvelopeFactor::copy_envelope(const Eigen::Ref<const Eigen::MatrixXd>& H) {
  const int first = column(states_);
  const auto unknown = [&](int i) { return first + order_[static_cast<std::size_t>(i)]; };
  for (int s = 0; s < states_; ++s) {
    const int c = column(s);
    const int rows = kState + rows_below(s);
    L_.block(c, c, rows, kState) = H.block(c, c, rows, kState);
    for (int i = s == 0 ? 0 : far_; i < border_; ++i) {
      L_.row(first + i).segment<kState>(c) = H.row(unknown(i)).segment<kState>(c);
    }
    if (far_ > 0) {
      auto y = L_.block<kState, kState>(first + border_, c);
      if (s == 0) y.setIdentity();
      if (s > 0) y.setZero();
    }
  }
  for (int c = 0; c < border_; ++c) {
    for (int r = c; r < border_; ++r) {
      L_(first + r, first + c) =
          H(std::max(unknown(r), unknown(c)), std::min(unknown(r), unknown(c)));
    }
  }
  if (far_ > 0) L_.block(first + border_, near_row(), kState, near() + kState).setZero();
  L_.diagonal().head(first + border_) *= 1.0 + damping_;
  floor_.head(first + border_) = cholesky::kPivotTolerance * L_.diagonal().head(first + border_);
}

bool EnvelopeFactor::factorise_state(int s) {
  const int c = column(s);
  const int next = column(s + 1);
  const int rows = rows_below(s);
  auto own = L_.block<kState, kState>(c, c);
  auto states = L_.block(next, c, rows, kState);
  auto border = L_.block(near_row(), c, last_rows(), kState);
  if (!cholesky::factorise(own, floor_.segment<kState>(c))) return false;
  cholesky::divide_right(own, states);
  cholesky::divide_right(own, border);
  L_.block(next, next, rows, rows).selfadjointView<Eigen::Lower>().rankUpdate(states, -1.0);
  L_.block(near_row(), next, last_rows(), rows).noalias() -= border * states.transpose();
  return true;
}

bool EnvelopeFactor::factorise_border() {
  auto corner = L_.block(near_row(), near_row(), last_rows(), last_rows());
  for (int s = 0; s < states_; s += kStatesPerPanel) {
    const int width = column(std::min(kStatesPerPanel, states_ - s));
    corner.selfadjointView<Eigen::Lower>().rankUpdate(
        L_.block(near_row(), column(s), last_rows(), width), -1.0);
  }
  if (far_ > 0) subtract_far();
  const int at = column(states_);
  return cholesky::factorise(L_.block(at, at, border_, border_), floor_.segment(at, border_));
}

void EnvelopeFactor::subtract_far() {
  const int y = near_row() + near();  // there the corner holds -Z and -sum_s Y_s L_as^T
  auto far_Z = far_Z_.topRows(far_);
  far_Z.noalias() =
      far_coupling() * Eigen::Matrix<double, kState, kState>(
                           L_.block<kState, kState>(y, y).selfadjointView<Eigen::Lower>());
  L_.block(far_row(), far_row(), far_, far_).triangularView<Eigen::Lower>() +=
      far_Z * far_coupling().transpose();
  L_.block(near_row(), far_row(), near(), far_).noalias() +=
      L_.block(y, near_row(), kState, near()).transpose() * far_coupling().transpose();
}

}  // namespace rio

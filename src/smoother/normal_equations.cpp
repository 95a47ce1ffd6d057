// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/normal_equations.hpp"

#include <numeric>

#include "rio/core/symmetric.hpp"

namespace rio {

NormalEquations::NormalEquations(int max_states, int max_border)
    : max_states_(max_states),
      max_border_(max_border),
      H_(Eigen::MatrixXd::Zero(capacity(), capacity())),
      g_(Eigen::VectorXd::Zero(capacity())),
      W_(Eigen::MatrixXd::Zero(capacity(), kState)),
      factor_(max_states, max_border) {
  RIO_ASSERT(max_states > 0 && max_border >= 0);
  reach_.reserve(static_cast<std::size_t>(max_states));
  border_reach_.reserve(static_cast<std::size_t>(max_border));
}

void NormalEquations::clear(int states, int border) {
  RIO_ASSERT(states > 0 && states <= max_states_ && border >= 0 && border <= max_border_);
  if (states != states_ || border != border_) factor_.clear();
  states_ = states;
  border_ = border;
  highest_ = -1;
  reach_.resize(static_cast<std::size_t>(states));
  std::iota(reach_.begin(), reach_.end(), 0);
  border_reach_.assign(static_cast<std::size_t>(border), -1);
  for (int s = 0; s < states_; ++s) {  // the lower triangle
    H_.block(column(s), column(s), size() - column(s), kState).setZero();
  }
  H_.block(border_column(), border_column(), border_, border_).setZero();
  g_.head(size()).setZero();
}

void NormalEquations::add(const LinearRow& row, double weight) {
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
  if (highest < 0) return;
  couple(lowest, highest);
  row.for_each_segment(
      [&](int column, const double*, int length) { touch(column, length, highest); });
}

void NormalEquations::add_between(int state, const BetweenJacobian& J, const StateVector& r) {
  RIO_ASSERT(state >= 0 && state + 1 < states_);
  couple(state, state + 1);
  H_.block<2 * kState, 2 * kState>(column(state), column(state))
      .selfadjointView<Eigen::Lower>()
      .rankUpdate(J.transpose());
  g_.segment<2 * kState>(column(state)).noalias() -= J.transpose() * r;
}

void NormalEquations::add_quadratic(int leading_states, const Eigen::Ref<const Eigen::MatrixXd>& A,
                                    const Eigen::Ref<const Eigen::VectorXd>& g) {
  const Eigen::Index m = column(leading_states);
  const Eigen::Index rest = A.rows() - m;
  const Eigen::Index at = border_column();
  RIO_ASSERT(leading_states <= states_ && rest >= 0 && rest <= border_);
  RIO_ASSERT(A.cols() == A.rows() && g.size() == A.rows());
  if (leading_states > 0) couple(0, leading_states - 1);
  touch(border_column(), static_cast<int>(rest), leading_states - 1);
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

void NormalEquations::solve(Eigen::VectorXd* dx) const {
  RIO_ASSERT(dx->size() >= size());
  dx->head(size()) = g();
  factor_.solve(dx->head(size()));
}

bool NormalEquations::tail_covariance(Eigen::MatrixXd* P) {
  RIO_ASSERT(P->rows() >= tail_size() && P->cols() >= tail_size());
  return factor_.tail_inverse(P->topLeftCorner(tail_size(), tail_size()));
}

bool NormalEquations::eliminate_oldest(int* leading_states, Eigen::MatrixXd* A,
                                       Eigen::VectorXd* g) {
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
  mirror_lower(rest);
  g->head(m) = g_.segment(kState, m);
  g->segment(m, border_) = g_.segment(at, border_);
  g->head(size).noalias() -= W * y;
  return true;
}

void NormalEquations::couple(int lowest, int highest) {
  for (int s = lowest; s < highest; ++s) {
    int& reach = reach_[static_cast<std::size_t>(s)];
    reach = std::max(reach, highest);
  }
  highest_ = std::max(highest_, highest);
}

}  // namespace rio

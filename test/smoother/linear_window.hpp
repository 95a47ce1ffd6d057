// SPDX-License-Identifier: BSD-3-Clause
// Random linear windows, and what they come to with dense matrices of Eigen.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <initializer_list>
#include <vector>

#include "rio/smoother/normal_equations.hpp"
#include "support/dense_rows.hpp"

namespace rio::test {

inline constexpr int kState = NormalEquations::kState;
inline constexpr int kMaxStates = 12;
inline constexpr int kMaxBorder = 130;
// The condition of the random problems is below 1e6, the round-off of their sums some 1e-16.
inline constexpr double kRelative = 1e-9;

struct Between {
  int state = 0;
  NormalEquations::BetweenJacobian J;
  NormalEquations::StateVector r;
};
struct Row {
  LinearRow row;
  double weight = 1.0;
};
struct Quadratic {
  int states = 0;
  MatrixXd A = MatrixXd(0, 0);
  VectorXd g = VectorXd(0);
};

/// All that a window knows.
struct LinearWindow {
  int states = 0;
  int border = 0;
  std::vector<Row> rows;
  std::vector<Between> chain;
  Quadratic prior;

  int size() const { return kState * states + border; }
  void add_to(NormalEquations* equations) const {
    equations->clear(states, border);
    for (const Row& r : rows) equations->add(r.row, r.weight);
    for (const Between& b : chain) equations->add_between(b.state, b.J, b.r);
    equations->add_quadratic(prior.states, prior.A, prior.g);
  }
};

/// The same with all its zeros.
struct Dense {
  MatrixXd H;
  VectorXd g;
};

inline Dense dense(const LinearWindow& window) {
  const int n = window.size();
  Dense d{MatrixXd::Zero(n, n), VectorXd::Zero(n)};
  for (const Row& r : window.rows) {
    const VectorXd h = dense_rows({&r.row, 1}, n).H.transpose();
    d.H += r.weight / r.row.variance * h * h.transpose();
    d.g += r.weight / r.row.variance * r.row.residual * h;
  }
  for (const Between& b : window.chain) {
    MatrixXd J = MatrixXd::Zero(kState, n);
    J.middleCols(kState * b.state, 2 * kState) = b.J;
    d.H += J.transpose() * J;
    d.g -= J.transpose() * b.r;
  }
  const Eigen::Index known = window.prior.A.rows();
  MatrixXd select = MatrixXd::Zero(known, n);
  const int leading = kState * window.prior.states;
  for (Eigen::Index i = 0; i < known; ++i) {
    select(i, i < leading ? i : kState * window.states + i - leading) = 1.0;
  }
  d.H += select.transpose() * window.prior.A * select;
  d.g += select.transpose() * window.prior.g;
  return d;
}

/// What is left when the first `eliminated` unknowns are gone.
inline Dense schur(const Dense& d, Eigen::Index eliminated) {
  const Eigen::Index rest = d.H.rows() - eliminated;
  const MatrixXd K =
      solve(d.H.topLeftCorner(eliminated, eliminated), d.H.topRightCorner(eliminated, rest))
          .transpose();
  return {d.H.bottomRightCorner(rest, rest) - K * d.H.topRightCorner(eliminated, rest),
          d.g.tail(rest) - K * d.g.head(eliminated)};
}

inline int random_index(sim::Random& random, int count) {
  return static_cast<int>(random.uniform(0.0, count));
}

inline Row make_row(sim::Random& random, std::initializer_list<LinearRow::Segment> segments) {
  Row r;
  for (std::size_t i = 0; i < r.row.h.size(); ++i) r.row.h[i] = random.normal();
  for (const LinearRow::Segment& s : segments) {
    if (s.length > 0) r.row.segments[r.row.segment_count++] = s;
  }
  r.row.residual = random.normal();
  r.row.variance = random.uniform(0.5, 2.0);
  r.weight = random.uniform(0.2, 1.0);
  return r;
}

/// A chain of states, a prior, and measurements of one state, of any two states and of the border.
/// @param trails states that are not neighbours are coupled as well
inline LinearWindow random_window(sim::Random& random, int states, int border, bool trails) {
  LinearWindow w;
  w.states = states;
  w.border = border;
  const int at = kState * states;
  const auto landmark = [&]() -> LinearRow::Segment {
    const int length = std::min(3, border);
    return {at + random_index(random, border - length + 1), length};
  };
  for (int s = 0; s + 1 < states; ++s) {
    Between b;
    b.state = s;
    b.J = 0.1 * random_matrix(random, kState, 2 * kState);
    b.J.leftCols<kState>().diagonal().array() -= 1.0;
    b.J.rightCols<kState>().diagonal().array() += 1.0;
    b.r = random_matrix(random, kState, 1);
    w.chain.push_back(b);
  }
  for (int i = 0; i < border; ++i) w.rows.push_back(make_row(random, {{at + i, 1}}));
  for (int i = 0; i < 3 * states; ++i) {
    const int s = kState * random_index(random, states);
    w.rows.push_back(make_row(random, {{s, 6}, {s + 6, 3}, landmark()}));
    w.rows.push_back(make_row(random, {landmark(), {s + 9, 3}, landmark()}));
    if (!trails) continue;
    const int other = kState * random_index(random, states);
    const int third = kState * random_index(random, states);
    w.rows.push_back(make_row(random, {{s, 6}, {other, 6}, landmark(), {third + 3, 3}}));
  }
  const int known = trails ? 1 + random_index(random, states) : 1;
  const int n = kState * known + border / 2;  // the landmarks of the second half are new
  const MatrixXd B = 0.1 * random_matrix(random, n, n);
  w.prior = {known, MatrixXd::Identity(n, n) + B * B.transpose(), random_matrix(random, n, 1)};
  return w;
}

inline std::vector<LinearWindow> random_windows() {
  sim::Random random(41);
  std::vector<LinearWindow> windows;
  for (int i = 0; i < 100; ++i) {
    windows.push_back(random_window(random, 1 + i % kMaxStates, random_index(random, 61), i % 3));
  }
  return windows;
}

/// The equations of such a window.
class NormalEquationsTest : public testing::Test {
 protected:
  VectorXd solution() const {
    equations_.solve(&dx_);
    return dx_.head(equations_.size());
  }
  /// Empty if refused.
  MatrixXd tail_covariance() {
    MatrixXd& P = A_;
    if (!equations_.tail_covariance(&P)) return MatrixXd(0, 0);
    return P.topLeftCorner(equations_.tail_size(), equations_.tail_size());
  }
  Quadratic eliminate() {
    int leading = -1;
    EXPECT_TRUE(equations_.eliminate_oldest(&leading, &A_, &dx_));
    const int n = kState * leading + equations_.border();
    return {leading, A_.topLeftCorner(n, n), dx_.head(n)};
  }

  NormalEquations equations_{kMaxStates, kMaxBorder};
  MatrixXd A_ = MatrixXd::Zero(equations_.capacity(), equations_.capacity());
  mutable VectorXd dx_ = VectorXd::Zero(equations_.capacity());
};

}  // namespace rio::test

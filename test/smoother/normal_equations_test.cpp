// SPDX-License-Identifier: BSD-3-Clause
// The envelope solver against dense matrices of Eigen, on random windows: factorisation, solution,
// covariance of the tail, elimination of the oldest state.
#include "rio/smoother/normal_equations.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "smoother/linear_window.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

TEST_F(NormalEquationsTest, EqualsTheDenseSystem) {
  for (const LinearWindow& window : random_windows()) {
    window.add_to(&equations_);
    const Dense d = dense(window);
    expect_close(MatrixXd(equations_.H().selfadjointView<Eigen::Lower>()), d.H, kRelative);
    expect_close(equations_.g(), d.g, kRelative);
    ASSERT_TRUE(equations_.factorise());
    expect_close(solution(), solve(d.H, d.g), kRelative);
    const MatrixXd P = tail_covariance();
    const int tail = equations_.tail_size();
    expect_close(P, d.H.inverse().bottomRightCorner(tail, tail), kRelative);
    EXPECT_EQ(P, P.transpose());
  }
}

// The oldest state is eliminated.
TEST_F(NormalEquationsTest, EliminationEqualsTheSchurComplement) {
  for (const LinearWindow& window : random_windows()) {
    window.add_to(&equations_);
    const Dense expected = schur(dense(window), kState);
    ASSERT_TRUE(equations_.factorise());
    const VectorXd before = solution();
    const Quadratic rest = eliminate();
    EXPECT_EQ(rest.states, window.states - 1);  // the chain touches every state
    expect_close(rest.A, expected.H, kRelative);
    expect_close(rest.g, expected.g, kRelative);
    EXPECT_EQ(rest.A, rest.A.transpose());
    EXPECT_EQ(solution(), before);  // the factor is still there
  }
}

TEST_F(NormalEquationsTest, OnlyTheMarkovBlanketOfTheOldestStateIsLeft) {
  sim::Random random(44);
  LinearWindow oldest = random_window(random, 7, 9, false);  // its measurements alone
  oldest.chain.resize(1);
  std::erase_if(oldest.rows, [](const Row& r) {
    bool touches = false;
    r.row.for_each_segment([&](int column, const double*, int) { touches |= column < kState; });
    return !touches;
  });
  oldest.add_to(&equations_);
  EXPECT_EQ(eliminate().states, 1);
  equations_.add(make_row(random, {{0, 6}, {kState * 4, 6}}).row);
  EXPECT_EQ(eliminate().states, 4);
}

TEST_F(NormalEquationsTest, DampingIsRelativeToTheDiagonalAndForgotten) {
  sim::Random random(42);
  const LinearWindow window = random_window(random, 6, 20, true);
  window.add_to(&equations_);
  const Dense d = dense(window);
  const Dense rest = schur(d, kState);
  for (const double damping : {0.3, 1e3, 0.0}) {
    MatrixXd H = d.H;
    H.diagonal() *= 1.0 + damping;
    ASSERT_TRUE(equations_.factorise(damping));
    expect_close(solution(), solve(H, d.g), kRelative);
    EXPECT_EQ(tail_covariance().size() == 0, damping > 0.0);  // no covariance of a damped system
    expect_close(eliminate().A, rest.H, kRelative);           // never damped
  }
}

TEST_F(NormalEquationsTest, ReportsASystemThatIsNotPositiveDefiniteAndGoesOn) {
  sim::Random random(43);
  const LinearWindow window = random_window(random, 5, 12, true);
  LinearWindow unseen_landmark = window;
  unseen_landmark.border += 3;
  LinearWindow unseen_state = window;
  unseen_state.chain.pop_back();
  unseen_state.rows.clear();
  LinearWindow negative = window;
  negative.prior.A(0, 0) = -1e3;
  LinearWindow negative_border = window;
  negative_border.prior.A.bottomRightCorner(1, 1).setConstant(-1e3);
  LinearWindow broken = window;
  broken.rows.back().row.h[0] = std::numeric_limits<double>::quiet_NaN();
  int number = 0;
  for (const LinearWindow& bad :
       {unseen_landmark, unseen_state, negative, negative_border, broken}) {
    SCOPED_TRACE(number++);
    bad.add_to(&equations_);
    EXPECT_FALSE(equations_.factorise());
    EXPECT_EQ(tail_covariance().size(), 0);
    window.add_to(&equations_);
    ASSERT_TRUE(equations_.factorise());
    const Dense d = dense(window);
    expect_close(solution(), solve(d.H, d.g), kRelative);
  }
  negative.add_to(&equations_);
  int leading = 0;
  EXPECT_FALSE(equations_.eliminate_oldest(&leading, &A_, &dx_));
}

// The last error of the states is known between them only: the very last pivot is round-off, of
// either sign.
TEST_F(NormalEquationsTest, ReportsAChainWithOneUnknownOrigin) {
  sim::Random random(49);
  for (int i = 0; i < 20; ++i) {
    LinearWindow chain = random_window(random, 2 + i % 5, 0, false);
    chain.rows.clear();
    for (Between& b : chain.chain) b.J.leftCols<kState>() = -b.J.rightCols<kState>();
    chain.prior.A.row(kState - 1).setZero();
    chain.prior.A.col(kState - 1).setZero();
    chain.add_to(&equations_);
    EXPECT_FALSE(equations_.factorise());
    EXPECT_TRUE(equations_.factorise(1e-3));  // damping makes it definite
  }
}

TEST_F(NormalEquationsTest, TheEnvelopeFollowsTheMeasurements) {
  sim::Random random(47);
  const auto expect_reach = [this](const std::vector<int>& expected) {
    for (int s = 0; s < equations_.states(); ++s) {
      EXPECT_EQ(equations_.reach(s), expected[static_cast<std::size_t>(s)]) << s;
    }
  };
  equations_.clear(6, 8);
  const int landmark = equations_.border_column();
  equations_.add(make_row(random, {{landmark, 3}, {3 * kState, 6}}).row);
  expect_reach({0, 1, 2, 3, 4, 5});
  random_window(random, 6, 8, false).add_to(&equations_);
  expect_reach({1, 2, 3, 4, 5, 5});
  equations_.add(make_row(random, {{4 * kState, 6}, {landmark, 3}, {kState, 6}}).row);
  expect_reach({1, 4, 4, 4, 5, 5});
  equations_.add_quadratic(4, MatrixXd::Identity(4 * kState, 4 * kState),
                           VectorXd::Zero(4 * kState));
  expect_reach({3, 4, 4, 4, 5, 5});
  equations_.clear(6, 8);
  expect_reach({0, 1, 2, 3, 4, 5});
}

}  // namespace
}  // namespace rio::test

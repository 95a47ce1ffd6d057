// SPDX-License-Identifier: BSD-3-Clause
// The oldest state eliminated from random windows, against the Schur complement of dense matrices.
#include <gtest/gtest.h>

#include <utility>

#include "smoother/linear_window.hpp"

namespace rio::test {
namespace {

using Elimination = NormalEquationsTest;

TEST_F(Elimination, EliminationEqualsTheSchurComplement) {
  for (const LinearWindow& window : random_windows()) {
    window.add_to(&equations_);
    const Dense expected = schur(dense(window), kState);
    ASSERT_TRUE(equations_.factorise());
    const VectorXd before = solution();
    const Quadratic rest = eliminate();
    EXPECT_EQ(rest.states, window.states - 1);  // the chain touches every state
    expect_close(rest.A, expected.H);
    expect_close(rest.g, expected.g);
    EXPECT_EQ(rest.A, rest.A.transpose());
    EXPECT_EQ(solution(), before);  // the factor is still there
  }
}

bool touches_oldest(const LinearRow& row) {
  bool touches = false;
  row.for_each_segment([&](int column, const double*, int) { touches |= column < kState; });
  return touches;
}

/// The measurements of state 0, and those that stay, numbered without it.
std::pair<LinearWindow, LinearWindow> split(const LinearWindow& window) {
  LinearWindow gone = window;
  LinearWindow stays = window;
  gone.rows.clear();
  gone.chain.clear();
  stays.rows.clear();
  stays.chain.clear();
  stays.states -= 1;
  stays.prior = {};
  for (const Row& r : window.rows) {
    (touches_oldest(r.row) ? gone : stays).rows.push_back(r);
  }
  for (const Between& b : window.chain) (b.state == 0 ? gone : stays).chain.push_back(b);
  for (Row& r : stays.rows) {
    for (LinearRow::Segment& s : r.row.segments) s.column -= kState;
  }
  for (Between& b : stays.chain) b.state -= 1;
  return {gone, stays};
}

TEST_F(Elimination, TheWindowWithoutItsOldestStateHasTheSameSolution) {
  for (const LinearWindow& window : random_windows()) {
    if (window.states == 1) continue;
    window.add_to(&equations_);
    ASSERT_TRUE(equations_.factorise());
    const VectorXd full = solution();
    const MatrixXd P = tail_covariance();
    auto [gone, stays] = split(window);
    gone.add_to(&equations_);
    stays.prior = eliminate();
    stays.add_to(&equations_);
    ASSERT_TRUE(equations_.factorise());
    expect_close(solution(), full.tail(stays.size()));
    expect_close(tail_covariance(), P);
  }
}

TEST_F(Elimination, OnlyTheMarkovBlanketOfTheOldestStateIsLeft) {
  sim::Random random(44);
  const LinearWindow window = split(random_window(random, 7, 9, false)).first;
  window.add_to(&equations_);
  EXPECT_EQ(eliminate().states, 1);
  equations_.add(make_row(random, {{0, 6}, {kState * 4, 6}}).row);
  EXPECT_EQ(eliminate().states, 4);
}

TEST_F(Elimination, EliminatingOneStateAfterTheOtherEqualsDense) {
  sim::Random random(45);
  const LinearWindow full = random_window(random, kMaxStates, 33, true);
  const Dense expected = schur(dense(full), kState * (full.states - 1));
  LinearWindow window = full;
  while (window.states > 1) {
    auto [gone, stays] = split(window);
    gone.add_to(&equations_);
    stays.prior = eliminate();
    window = stays;
  }
  const Dense last = dense(window);
  expect_close(last.H, expected.H);
  expect_close(last.g, expected.g);
  full.add_to(&equations_);
  ASSERT_TRUE(equations_.factorise());
  expect_close(tail_covariance(), last.H.inverse());
}
}  // namespace
}  // namespace rio::test

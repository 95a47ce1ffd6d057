// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/assignment.hpp"

#include <gtest/gtest.h>

#include "support/random_state.hpp"

namespace rio {
namespace {

using Costs = Eigen::MatrixXd;

// A row left alone pays the gate.
struct Solution {
  double total = 0.0;
  std::vector<int> column_of;
};

Solution solve(Assignment& assignment, const Costs& costs, double gate) {
  const auto rows = static_cast<std::size_t>(costs.rows());
  const auto columns = static_cast<std::size_t>(costs.cols());
  assignment.begin(rows, columns, gate);
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      assignment.set(r, c, costs(static_cast<int>(r), static_cast<int>(c)));
    }
  }
  assignment.solve();
  Solution s;
  std::vector<int> uses(columns, 0);
  for (std::size_t r = 0; r < rows; ++r) {
    const int column = assignment.column_of(r);
    s.column_of.push_back(column);
    if (column == Assignment::kNone) {
      s.total += gate;
      continue;
    }
    const double cost = costs(static_cast<int>(r), column);
    EXPECT_LT(cost, gate);
    s.total += cost;
    ++uses[static_cast<std::size_t>(column)];
  }
  for (const int n : uses) EXPECT_LE(n, 1);
  return s;
}

// Every way to give the rows from `row` on a free column or none.
double brute_force(const Costs& costs, double gate, int row, std::vector<char>& used) {
  if (row == costs.rows()) return 0.0;
  double best = gate + brute_force(costs, gate, row + 1, used);
  for (int c = 0; c < costs.cols(); ++c) {
    char& taken = used[static_cast<std::size_t>(c)];
    if (taken != 0 || costs(row, c) >= gate) continue;
    taken = 1;
    best = std::min(best, costs(row, c) + brute_force(costs, gate, row + 1, used));
    taken = 0;
  }
  return best;
}

TEST(Assignment, EqualsBruteForceOnSmallProblems) {
  test::Random random(1);
  Assignment assignment(6, 6);
  for (int run = 0; run < 1500; ++run) {
    const bool ties = run % 3 == 0;
    // from nearly nothing to everything allowed; with ties some cost as much as the gate
    const double gate = ties ? 2.0 : random.uniform(0.05, 1.2);
    Costs costs(static_cast<int>(random.index(7)), static_cast<int>(random.index(7)));
    for (double& cost : costs.reshaped()) {
      cost = ties ? static_cast<double>(random.index(4)) : random.uniform(0.0, 1.0);
    }
    std::vector<char> used(static_cast<std::size_t>(costs.cols()), 0);
    const Solution first = solve(assignment, costs, gate);
    EXPECT_NEAR(first.total, brute_force(costs, gate, 0, used), 1e-12) << gate << "\n" << costs;
    EXPECT_EQ(first.column_of, solve(assignment, costs, gate).column_of);
  }
}

// By duality: with prices u <= gate of the rows and v <= 0 of the columns no total is below their
// sum if every cost is at least u + v; that sum is reached if the cost is u + v on pairs that leave
// alone only rows with u = gate and columns with v = 0.
TEST(Assignment, ReachesTheSumOfThePricesOnLargeProblems) {
  test::Random random(3);
  Assignment assignment(148, 128);
  struct Size {
    std::size_t rows, columns, pairs;
  };
  for (const Size& size : {Size{100, 100, 100}, Size{100, 100, 60}, Size{148, 60, 60},
                           Size{148, 60, 20}, Size{40, 128, 40}, Size{128, 128, 120}}) {
    const double gate = random.uniform(0.5, 2.0);
    Eigen::VectorXd u = Eigen::VectorXd::Constant(static_cast<int>(size.rows), gate);
    Eigen::VectorXd v = Eigen::VectorXd::Zero(static_cast<int>(size.columns));
    const auto pairs = static_cast<int>(size.pairs);
    for (double& price : u.head(pairs)) price = gate * random.uniform(0.5, 1.0);
    for (double& price : v.head(pairs)) price = gate * random.uniform(-0.5, 0.0);
    Costs costs = u.replicate(1, v.size()) + v.transpose().replicate(u.size(), 1);
    for (double& cost : costs.reshaped())
      cost += 2.0 * gate * std::pow(random.uniform(0.0, 1.0), 2);
    for (int i = 0; i < pairs; ++i) costs(i, pairs - 1 - i) = u[i] + v[pairs - 1 - i];
    EXPECT_NEAR(solve(assignment, costs, gate).total, u.sum() + v.sum(), 1e-9)
        << size.rows << "x" << size.columns << " pairs " << size.pairs;
    // nearly all beyond the gate: rounding takes none of them
    for (double& cost : costs.reshaped()) cost = gate * random.uniform(0.0, 50.0);
    solve(assignment, costs, gate);
  }
}

TEST(Assignment, UnsetAndHopelessPairsAreNeverAssigned) {
  Assignment assignment(4, 4);
  EXPECT_EQ(solve(assignment, Costs::Constant(4, 2, 1e300), 1.0).total, 4.0);
  assignment.begin(3, 3, 0.5);
  assignment.set(0, 2, 0.1);
  assignment.set(2, 2, 0.05);
  assignment.set(2, 0, 0.2);
  assignment.solve();
  EXPECT_EQ(assignment.column_of(0), 2);
  EXPECT_EQ(assignment.column_of(1), Assignment::kNone);
  EXPECT_EQ(assignment.column_of(2), 0);
  assignment.begin(3, 3, 0.5);  // nothing is left of the problem before
  assignment.solve();
  for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(assignment.column_of(r), Assignment::kNone);
}

}  // namespace
}  // namespace rio

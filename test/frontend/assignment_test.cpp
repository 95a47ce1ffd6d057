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

// Minimum-cost flow: one augmenting path of Bellman and Ford at a time, while it lowers the total.
double successive_shortest_paths(const Costs& costs, double gate) {
  const auto rows = static_cast<int>(costs.rows());
  const auto columns = static_cast<int>(costs.cols());
  std::vector<int> row_of(static_cast<std::size_t>(columns), -1);
  std::vector<int> column_of(static_cast<std::size_t>(rows), -1);
  double total = gate * rows;
  for (;;) {
    constexpr double kFar = 1e18;
    std::vector<double> to_row(column_of.size(), kFar);
    std::vector<double> to_column(row_of.size(), kFar);
    std::vector<int> from(row_of.size(), -1);
    for (std::size_t r = 0; r < column_of.size(); ++r) {
      if (column_of[r] < 0) to_row[r] = 0.0;
    }
    for (bool changed = true; changed;) {
      changed = false;
      for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
          const auto i = static_cast<std::size_t>(r);
          const auto j = static_cast<std::size_t>(c);
          const double length = to_row[i] + costs(r, c);
          if (costs(r, c) >= gate || column_of[i] == c || length >= to_column[j] - 1e-12) continue;
          to_column[j] = length;
          from[j] = r;
          if (row_of[j] >= 0)
            to_row[static_cast<std::size_t>(row_of[j])] = length - costs(row_of[j], c);
          changed = true;
        }
      }
    }
    int end = -1;
    for (int c = 0; c < columns; ++c) {
      const auto j = static_cast<std::size_t>(c);
      if (row_of[j] < 0 && (end < 0 || to_column[j] < to_column[static_cast<std::size_t>(end)]))
        end = c;
    }
    if (end < 0 || to_column[static_cast<std::size_t>(end)] >= gate) return total;
    total += to_column[static_cast<std::size_t>(end)] - gate;
    while (end >= 0) {
      const int r = from[static_cast<std::size_t>(end)];
      const int previous = column_of[static_cast<std::size_t>(r)];
      row_of[static_cast<std::size_t>(end)] = r;
      column_of[static_cast<std::size_t>(r)] = end;
      end = previous;
    }
  }
}

Costs random_costs(test::Random& random, std::size_t rows, std::size_t columns) {
  Costs costs(static_cast<int>(rows), static_cast<int>(columns));
  for (double& cost : costs.reshaped()) cost = random.uniform(0.0, 1.0);
  return costs;
}

TEST(Assignment, EqualsBruteForceOnSmallProblems) {
  test::Random random(1);
  Assignment assignment(6, 6);
  for (int run = 0; run < 1000; ++run) {
    const Costs costs = random_costs(random, 1 + random.index(6), 1 + random.index(6));
    const double gate = random.uniform(0.05, 1.2);  // from nearly nothing to everything allowed
    std::vector<char> used(static_cast<std::size_t>(costs.cols()), 0);
    EXPECT_NEAR(solve(assignment, costs, gate).total, brute_force(costs, gate, 0, used), 1e-12)
        << "gate " << gate << "\n"
        << costs;
  }
}

TEST(Assignment, TiesAreSolvedToTheSameTotal) {
  test::Random random(2);
  Assignment assignment(6, 6);
  for (int run = 0; run < 500; ++run) {
    Costs costs(static_cast<int>(1 + random.index(6)), static_cast<int>(1 + random.index(6)));
    for (double& cost : costs.reshaped()) cost = static_cast<double>(random.index(4));
    std::vector<char> used(static_cast<std::size_t>(costs.cols()), 0);
    const Solution first = solve(assignment, costs, 2.5);
    EXPECT_EQ(first.total, brute_force(costs, 2.5, 0, used)) << costs;
    EXPECT_EQ(first.column_of, solve(assignment, costs, 2.5).column_of);
  }
}

TEST(Assignment, EqualsMinimumCostFlowOnLargeProblems) {
  test::Random random(3);
  Assignment assignment(148, 128);
  struct Size {
    std::size_t rows, columns;
    double gate;
  };
  for (const Size& size : {Size{100, 100, 2.0}, Size{100, 100, 0.03}, Size{148, 60, 0.02},
                           Size{148, 60, 2.0}, Size{40, 128, 0.01}, Size{128, 128, 0.005}}) {
    const Costs costs = random_costs(random, size.rows, size.columns);
    EXPECT_NEAR(solve(assignment, costs, size.gate).total,
                successive_shortest_paths(costs, size.gate), 1e-9)
        << size.rows << "x" << size.columns << " gate " << size.gate;
  }
}

TEST(Assignment, GreedyWouldBeWrong) {
  Assignment assignment(2, 2);
  Costs costs(2, 2);
  costs << 0.10, 0.25, 0.05, 0.11;  // greedy: (1, 0) first, 0.30 in all instead of 0.21
  EXPECT_EQ(solve(assignment, costs, 0.3).column_of, (std::vector<int>{0, 1}));
  costs << 0.10, 0.35, 0.09, 0.12;  // greedy leaves row 0 alone: 0.39 instead of 0.22
  EXPECT_EQ(solve(assignment, costs, 0.3).column_of, (std::vector<int>{0, 1}));
}

TEST(Assignment, TheGateIsExclusive) {
  Assignment assignment(2, 3);
  Costs costs(2, 3);
  costs << 0.3, 0.5, 0.9, 0.31, 0.2999, 0.9;
  EXPECT_EQ(solve(assignment, costs, 0.3).column_of, (std::vector<int>{Assignment::kNone, 1}));
}

TEST(Assignment, EmptyAndHopelessProblems) {
  Assignment assignment(4, 4);
  EXPECT_EQ(solve(assignment, Costs(0, 0), 1.0).total, 0.0);
  EXPECT_EQ(solve(assignment, Costs(0, 3), 1.0).total, 0.0);
  EXPECT_EQ(solve(assignment, Costs(3, 0), 1.0).total, 3.0);
  EXPECT_EQ(solve(assignment, Costs::Constant(3, 4, 1.0), 1.0).total, 3.0);
  EXPECT_EQ(solve(assignment, Costs::Constant(4, 2, 1e300), 1.0).total, 4.0);
  EXPECT_EQ(solve(assignment, Costs::Zero(4, 4), 1.0).total, 0.0);
}

TEST(Assignment, UnsetPairsAreNeverAssigned) {
  Assignment assignment(3, 3);
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

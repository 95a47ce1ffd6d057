// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: optimal one-to-one assignment with a gate.
//
// Minimises the sum over rows of min(cost, gate), where a row left alone pays the gate: shortest
// augmenting paths with potentials (Kuhn 1955; Jonker and Volgenant 1987). Costs at or above the
// gate are capped before solving and never assigned. Exchange argument: capping loses nothing,
// because a row that pays the cap can give its column away at no extra cost.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "rio/core/assert.hpp"

namespace rio {

/// Solver with its work space allocated once.
class Assignment {
 public:
  Assignment(std::size_t max_rows, std::size_t max_columns);

  static constexpr int kNone = -1;

  /// Starts a problem with every cost at the gate.
  void begin(std::size_t rows, std::size_t columns, double gate);
  void set(std::size_t row, std::size_t column, double cost) {
    cost_[row * columns_ + column] = cost < gate_ ? cost : gate_;  // NaN is no match
  }
  double cost(std::size_t row, std::size_t column) const { return cost_[row * columns_ + column]; }

  /// After this, column_of(row) is the column of a row, or kNone.
  void solve();
  int column_of(std::size_t row) const { return row_of_[row]; }

 private:
  /// Assigns each of n "rows" one of m >= n "columns"; result in matched_row_ (1-based, 0 = free).
  template <class Cost>
  void augment(std::size_t n, std::size_t m, const Cost& cost_of) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::fill(row_potential_.begin(), row_potential_.end(), 0.0);
    std::fill(column_potential_.begin(), column_potential_.end(), 0.0);
    std::fill(matched_row_.begin(), matched_row_.end(), std::size_t{0});
    for (std::size_t i = 1; i <= n; ++i) {
      matched_row_[0] = i;
      std::size_t column = 0;
      std::fill(distance_.begin(), distance_.end(), kInfinity);
      std::fill(visited_.begin(), visited_.end(), char{0});
      do {
        visited_[column] = 1;
        const std::size_t row = matched_row_[column];
        double delta = kInfinity;
        std::size_t next = 0;
        for (std::size_t j = 1; j <= m; ++j) {
          if (visited_[j] != 0) continue;
          const double reduced =
              cost_of(row - 1, j - 1) - row_potential_[row] - column_potential_[j];
          if (reduced < distance_[j]) {
            distance_[j] = reduced;
            way_[j] = column;
          }
          if (distance_[j] < delta) {
            delta = distance_[j];
            next = j;
          }
        }
        for (std::size_t j = 0; j <= m; ++j) {
          if (visited_[j] != 0) {
            row_potential_[matched_row_[j]] += delta;
            column_potential_[j] -= delta;
          } else {
            distance_[j] -= delta;
          }
        }
        column = next;
      } while (matched_row_[column] != 0);
      while (column != 0) {
        const std::size_t previous = way_[column];
        matched_row_[column] = matched_row_[previous];
        column = previous;
      }
    }
    matched_row_[0] = 0;
  }

  [[maybe_unused]] std::size_t max_columns_;  ///< of the work space, for the assertion
  std::size_t rows_ = 0;
  std::size_t columns_ = 0;
  double gate_ = 0.0;
  std::vector<double> cost_;
  std::vector<int> row_of_;
  std::vector<std::size_t> row_list_;
  std::vector<std::size_t> column_list_;
  std::vector<double> row_potential_;
  std::vector<double> column_potential_;
  std::vector<std::size_t> matched_row_;
  std::vector<std::size_t> way_;
  std::vector<double> distance_;
  std::vector<char> visited_;
};

}  // namespace rio

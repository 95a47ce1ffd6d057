// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: optimal one-to-one assignment with a gate.
//
// Minimises the sum of the costs of the assigned pairs, where an unassigned row costs the gate. Row
// by row, the shortest augmenting path (Kuhn 1955; Jonker and Volgenant 1987) by Dijkstra's
// algorithm over the pairs below the gate only: few candidates per row, so few steps.
//
// (E1) dual variables u, v with u_r + v_c <= cost of every pair, equality for assigned pairs; u_r
//      <= gate, equality for unassigned rows: by duality the sum is minimal
// (E2) a path of length L from a row to a free column, or to a row that becomes unassigned, over
//      the reduced costs cost - u_r - v_c; then u_r += L - d_r, v_c -= L - d_c for nodes nearer
//      than L
#pragma once

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
  /// Sets the cost of a pair. At or above the gate, or NaN: no match.
  void set(std::size_t row, std::size_t column, double cost) {
    cost_[row * columns_ + column] = cost < gate_ ? cost : gate_;
  }
  double cost(std::size_t row, std::size_t column) const { return cost_[row * columns_ + column]; }

  /// After this, column_of(row) is the column of a row, or kNone.
  void solve();
  int column_of(std::size_t row) const { return column_of_[row]; }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  void augment(std::size_t start);
  /// Adds a row to the shortest-path tree at `distance` and updates the distances of its columns.
  void reach(std::size_t row, double distance);
  /// Settles and returns the nearest unsettled column; kNone if none is nearer than `limit`.
  int settle_nearest(double limit);
  /// Reassigns along the augmenting path from row `start` to `column`.
  void assign(std::size_t start, int column);

  [[maybe_unused]] std::size_t max_columns_;  ///< of the work space, for the assertion
  std::size_t rows_ = 0;
  std::size_t columns_ = 0;
  double gate_ = 0.0;
  std::vector<double> cost_;
  std::vector<std::size_t> candidates_;      ///< columns below the gate, row by row
  std::vector<std::size_t> candidates_end_;  ///< row r has [r] to [r + 1] of the candidates
  std::vector<int> column_of_;
  std::vector<int> row_of_;
  std::vector<double> u_, v_;
  // of one path
  std::vector<double> row_distance_, column_distance_;
  std::vector<std::size_t> from_;  ///< by column: the row before it
  std::vector<char> settled_;      ///< same
  std::vector<std::size_t> tree_;  ///< rows reached
  std::vector<std::size_t> seen_;  ///< columns with a distance
};

}  // namespace rio

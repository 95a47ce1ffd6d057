// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/assignment.hpp"

#include <algorithm>

namespace rio {

Assignment::Assignment(std::size_t max_rows, std::size_t max_columns)
    : max_columns_(max_columns),
      cost_(max_rows * max_columns),
      candidates_end_(max_rows + 1),
      column_of_(max_rows, kNone),
      row_of_(max_columns, kNone),
      u_(max_rows),
      v_(max_columns),
      row_distance_(max_rows),
      column_distance_(max_columns, kInfinity),
      from_(max_columns),
      settled_(max_columns) {
  candidates_.reserve(max_rows * max_columns);
  tree_.reserve(max_rows);
  seen_.reserve(max_columns);
}

void Assignment::begin(std::size_t rows, std::size_t columns, double gate) {
  RIO_ASSERT(rows <= column_of_.size() && columns <= max_columns_);
  rows_ = rows;
  columns_ = columns;
  gate_ = gate;
  std::fill_n(cost_.begin(), rows * columns, gate);
}

void Assignment::solve() {
  candidates_.clear();
  for (std::size_t r = 0; r < rows_; ++r) {
    for (std::size_t c = 0; c < columns_; ++c) {
      if (cost(r, c) < gate_) candidates_.push_back(c);
    }
    candidates_end_[r + 1] = candidates_.size();
  }
  std::fill_n(column_of_.begin(), rows_, kNone);
  std::fill_n(row_of_.begin(), columns_, kNone);
  std::fill_n(v_.begin(), columns_, 0.0);
  for (std::size_t r = 0; r < rows_; ++r) augment(r);
}

void Assignment::augment(std::size_t start) {
  u_[start] = gate_;
  for (std::size_t k = candidates_end_[start]; k < candidates_end_[start + 1]; ++k) {
    u_[start] = std::min(u_[start], cost(start, candidates_[k]) - v_[candidates_[k]]);
  }
  tree_.clear();
  std::size_t row = start;
  double length = kInfinity;  // of the shortest path so far, which leaves a row unassigned
  std::size_t alone = start;
  int end = kNone;  // the free column, if one is nearer
  double distance = 0.0;
  while (true) {
    reach(row, distance);
    if (distance + gate_ - u_[row] < length) {
      length = distance + gate_ - u_[row];
      alone = row;
    }
    const int column = settle_nearest(length);
    if (column == kNone) break;
    const auto c = static_cast<std::size_t>(column);
    distance = column_distance_[c];
    if (row_of_[c] == kNone) {
      length = distance;
      end = column;
      break;
    }
    row = static_cast<std::size_t>(row_of_[c]);
  }
  for (const std::size_t r : tree_) u_[r] += length - row_distance_[r];  // (E2)
  for (const std::size_t c : seen_) {
    if (settled_[c] != 0) v_[c] -= length - column_distance_[c];
    column_distance_[c] = kInfinity;
    settled_[c] = 0;
  }
  seen_.clear();
  if (end == kNone) {
    end = column_of_[alone];
    column_of_[alone] = kNone;
    if (alone == start) return;
  }
  assign(start, end);
}

void Assignment::reach(std::size_t row, double distance) {
  tree_.push_back(row);
  row_distance_[row] = distance;
  for (std::size_t k = candidates_end_[row]; k < candidates_end_[row + 1]; ++k) {
    const std::size_t c = candidates_[k];
    if (settled_[c] != 0) continue;
    const double through = distance + (cost(row, c) - u_[row] - v_[c]);
    if (!(through < column_distance_[c])) continue;
    if (column_distance_[c] == kInfinity) seen_.push_back(c);
    column_distance_[c] = through;
    from_[c] = row;
  }
}

int Assignment::settle_nearest(double limit) {
  int nearest = kNone;
  for (const std::size_t c : seen_) {
    if (settled_[c] != 0 || !(column_distance_[c] < limit)) continue;
    limit = column_distance_[c];
    nearest = static_cast<int>(c);
  }
  if (nearest != kNone) settled_[static_cast<std::size_t>(nearest)] = 1;
  return nearest;
}

void Assignment::assign(std::size_t start, int column) {
  while (true) {
    const auto c = static_cast<std::size_t>(column);
    const std::size_t row = from_[c];
    const int before = column_of_[row];
    column_of_[row] = column;
    row_of_[c] = static_cast<int>(row);
    if (row == start) return;
    column = before;
  }
}

}  // namespace rio

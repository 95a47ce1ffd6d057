// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/assignment.hpp"

namespace rio {

Assignment::Assignment(std::size_t max_rows, std::size_t max_columns)
    : max_columns_(max_columns),
      cost_(max_rows * max_columns),
      row_of_(max_rows, kNone),
      column_list_(max_columns) {
  const std::size_t larger = std::max(max_rows, max_columns) + 1;
  row_list_.resize(max_rows);
  row_potential_.resize(larger);
  column_potential_.resize(larger);
  matched_row_.resize(larger);
  way_.resize(larger);
  distance_.resize(larger);
  visited_.resize(larger);
}

void Assignment::begin(std::size_t rows, std::size_t columns, double gate) {
  RIO_ASSERT(rows <= row_of_.size() && columns <= max_columns_);
  rows_ = rows;
  columns_ = columns;
  gate_ = gate;
  std::fill_n(cost_.begin(), static_cast<std::ptrdiff_t>(rows * columns), gate);
}

void Assignment::solve() {
  std::fill_n(row_of_.begin(), static_cast<std::ptrdiff_t>(rows_), kNone);
  // rows and columns without a candidate cannot be assigned: leave them out
  std::size_t n = 0;
  for (std::size_t r = 0; r < rows_; ++r) {
    for (std::size_t c = 0; c < columns_; ++c) {
      if (cost(r, c) < gate_) {
        row_list_[n++] = r;
        break;
      }
    }
  }
  std::size_t m = 0;
  for (std::size_t c = 0; c < columns_; ++c) {
    for (std::size_t i = 0; i < n; ++i) {
      if (cost(row_list_[i], c) < gate_) {
        column_list_[m++] = c;
        break;
      }
    }
  }
  if (n <= m) {
    augment(n, m,
            [this](std::size_t i, std::size_t j) { return cost(row_list_[i], column_list_[j]); });
  } else {
    augment(m, n,
            [this](std::size_t i, std::size_t j) { return cost(row_list_[j], column_list_[i]); });
  }
  for (std::size_t j = 1; j <= std::max(n, m); ++j) {
    if (matched_row_[j] == 0) continue;
    const std::size_t first = matched_row_[j] - 1;
    const std::size_t second = j - 1;
    const std::size_t r = row_list_[n <= m ? first : second];
    const std::size_t c = column_list_[n <= m ? second : first];
    if (cost(r, c) < gate_) row_of_[r] = static_cast<int>(c);
  }
}

}  // namespace rio

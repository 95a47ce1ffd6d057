// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: linearised measurement rows, sparse in the columns of the error state.
//
// A row is r = h . dx + n with a few non-zero segments in h and independent noise n. The rows of
// one block are gated together.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "rio/core/assert.hpp"
#include "rio/models/concept.hpp"
#include "rio/state/blocks.hpp"

namespace rio {

/// One row with the columns of its model's blocks in the error state.
struct LinearRow {
  static constexpr std::size_t kMaxSegments = 7;
  static constexpr std::size_t kMaxColumns = 24;
  struct Segment {
    int column = 0;
    int length = 0;
  };

  std::array<Segment, kMaxSegments> segments;
  std::size_t segment_count = 0;
  std::array<double, kMaxColumns> h{};  ///< coefficients of the segments in turn, then zeros
  double residual = 0.0;
  double variance = 0.0;  ///< of the noise

  /// f(first column, its coefficients, length) for every segment.
  template <class F>
  void for_each_segment(F&& f) const {
    const double* values = h.data();
    for (std::size_t s = 0; s < segment_count; ++s) {
      f(segments[s].column, values, segments[s].length);
      values += segments[s].length;
    }
  }
};

/// The rows of h = J dx for a Jacobian over the blocks of BlockList, plus a column for the time
/// offset. Residual and variance are not set.
/// @param columns first column of each block in the error state; -1 = not estimated
/// @param d_time derivative in the time offset, whose column is `time_column`; -1 = not estimated
template <int kDim, class... B>
std::array<LinearRow, static_cast<std::size_t>(kDim)> linear_rows(
    const JacobianOf<kDim, BlockList<B...>::kDof>& J, BlockList<B...>,
    const std::array<int, sizeof...(B)>& columns, const ResidualOf<kDim>& d_time, int time_column) {
  static_assert(BlockList<B...>::kDof < static_cast<int>(LinearRow::kMaxColumns));
  static_assert(sizeof...(B) < LinearRow::kMaxSegments);
  constexpr std::array<int, sizeof...(B)> kLengths = {B::kDof...};
  std::array<LinearRow, static_cast<std::size_t>(kDim)> rows;
  for (int i = 0; i < kDim; ++i) {
    LinearRow& row = rows[static_cast<std::size_t>(i)];
    std::size_t used = 0;
    int first = 0;
    for (std::size_t b = 0; b < columns.size(); ++b) {
      if (columns[b] >= 0) {
        row.segments[row.segment_count++] = {columns[b], kLengths[b]};
        for (int k = 0; k < kLengths[b]; ++k) row.h[used++] = J(i, first + k);
      }
      first += kLengths[b];
    }
    if (time_column >= 0) {
      row.segments[row.segment_count++] = {time_column, 1};
      row.h[used] = d_time[i];
    }
  }
  return rows;
}

/// Consecutive rows, gated together.
struct RowBlock {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Rows of one update; storage allocated once.
class RowBatch {
 public:
  explicit RowBatch(std::size_t capacity) {
    rows_.reserve(capacity);
    blocks_.reserve(capacity);
  }

  const std::vector<LinearRow>& rows() const { return rows_; }
  const std::vector<RowBlock>& blocks() const { return blocks_; }
  void clear() {
    rows_.clear();
    blocks_.clear();
  }

  /// Opens a block; the rows pushed after this belong to it.
  void begin_block() { blocks_.push_back({rows_.size(), 0}); }
  const RowBlock& last_block() const { return blocks_.back(); }
  /// Shifts the residual of the first row of the last block and adds to its noise variance.
  void correct_first_row(double shift, double variance) {
    LinearRow& row = rows_[blocks_.back().first];
    row.residual += shift;
    row.variance += variance;
  }
  /// Adds to the noise variance of the last row.
  void add_variance(double variance) { rows_.back().variance += variance; }
  /// Multiplies the noise variance of one row of the last block.
  void scale_row(std::size_t row, double factor) {
    rows_[blocks_.back().first + row].variance *= factor;
  }
  /// Multiplies the noise variance of the last block.
  void scale_variance(double factor) {
    for (std::size_t row = 0; row < blocks_.back().count; ++row) scale_row(row, factor);
  }
  /// Removes the last block and its rows.
  void drop_block() {
    rows_.resize(blocks_.back().first);
    blocks_.pop_back();
  }

  /// Appends a row to the open block.
  void push(const LinearRow& row) {
    RIO_ASSERT(rows_.size() < rows_.capacity());
    rows_.push_back(row);
    ++blocks_.back().count;
  }

 private:
  std::vector<LinearRow> rows_;
  std::vector<RowBlock> blocks_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/linear_rows.hpp"

namespace rio {

RowBatch::RowBatch(std::size_t capacity) {
  rows_.reserve(capacity);
  blocks_.reserve(capacity);
}

void RowBatch::clear() {
  rows_.clear();
  blocks_.clear();
}

void RowBatch::correct_first_row(double shift, double variance) {
  LinearRow& row = rows_[blocks_.back().first];
  row.residual += shift;
  row.variance += variance;
}

void RowBatch::scale_variance(double factor) {
  const RowBlock& block = blocks_.back();
  for (std::size_t i = 0; i < block.count; ++i) rows_[block.first + i].variance *= factor;
}

void RowBatch::drop_block() {
  rows_.resize(blocks_.back().first);
  blocks_.pop_back();
}

void RowBatch::push(const LinearRow& row) {
  RIO_ASSERT(rows_.size() < rows_.capacity());
  rows_.push_back(row);
  ++blocks_.back().count;
}

}  // namespace rio

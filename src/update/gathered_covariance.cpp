// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/gathered_covariance.hpp"

#include <algorithm>

namespace rio {

void GatheredCovariance::innovation_covariance(const RowBatch& batch, const RowBlock& block,
                                               BlockMatrix* S) {
  const auto m = static_cast<Eigen::Index>(block.count);
  const LinearRow* rows = &batch.rows()[block.first];
  S->resize(m, m);
  multiply(rows, block.count, *S);
  for (Eigen::Index i = 0; i < m; ++i) (*S)(i, i) += rows[i].variance;
}

void GatheredCovariance::multiply(const LinearRow* rows, std::size_t count,
                                  Eigen::Ref<Eigen::MatrixXd> S) {
  const bool gathered = gather(rows, count);
  std::array<double, kCapacity> Ph;
  for (std::size_t i = 0; i < count; ++i) {
    if (gathered) {
      std::fill_n(Ph.begin(), size_, 0.0);
      rows[i].for_each_segment([&](int column, const double* h, int length) {
        const int at = find(column);
        for (int k = 0; k < length; ++k) {
          const double* p = gathered_.col(at + k).data();
          for (int r = 0; r < size_; ++r) Ph[static_cast<std::size_t>(r)] += h[k] * p[r];
        }
      });
    }
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0.0;
      if (gathered) {
        rows[j].for_each_segment([&](int column, const double* h, int length) {
          const double* part = &Ph[static_cast<std::size_t>(find(column))];
          for (int k = 0; k < length; ++k) sum += h[k] * part[k];
        });
      } else {
        sum = P_->product(rows[i], rows[j]);
      }
      const auto row = static_cast<Eigen::Index>(i);
      const auto column = static_cast<Eigen::Index>(j);
      S(row, column) = S(column, row) = sum;
    }
  }
}

bool GatheredCovariance::gather(const LinearRow* rows, std::size_t count) {
  const Segments before = segments_;
  segments_.clear();
  size_ = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t s = 0; s < rows[i].segment_count; ++s) {
      const LinearRow::Segment& segment = rows[i].segments[s];
      if (find(segment.column) >= 0) continue;
      if (size_ + segment.length > kCapacity) {
        segments_.clear();
        return false;
      }
      (void)segments_.push_back({segment.column, segment.length, size_});
      size_ += segment.length;
    }
  }
  const auto known = [&before, this](std::size_t s) {
    return s < before.size() && before[s] == segments_[s];
  };
  const auto P = P_->matrix();
  for (std::size_t b = 0; b < segments_.size(); ++b) {
    for (std::size_t a = 0; a < segments_.size(); ++a) {
      if (known(a) && known(b)) continue;
      const Segment& row = segments_[a];
      const Segment& column = segments_[b];
      gathered_.block(row.at, column.at, row.length, column.length) =
          P.block(row.column, column.column, row.length, column.length);
    }
  }
  return true;
}

int GatheredCovariance::find(int column) const {
  for (const Segment& segment : segments_) {
    if (segment.column == column) return segment.at;
  }
  return -1;
}

}  // namespace rio

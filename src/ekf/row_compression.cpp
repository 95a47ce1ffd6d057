// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/row_compression.hpp"

#include <algorithm>
#include <cmath>

#include "rio/core/small_cholesky.hpp"

namespace rio {

namespace {

/// Both rows touch the same columns.
bool alike(const LinearRow& a, const LinearRow& b) {
  return a.segment_count == b.segment_count &&
         std::equal(a.segments.begin(), a.segments.begin() + a.segment_count, b.segments.begin(),
                    [](const LinearRow::Segment& x, const LinearRow::Segment& y) {
                      return x.column == y.column && x.length == y.length;
                    });
}

}  // namespace

RowCompression::RowCompression(std::size_t capacity)
    : out_(capacity),
      rows_(kColumns, static_cast<Eigen::Index>(capacity)),
      factor_(static_cast<Eigen::Index>(capacity), kMaxRank),
      residual_(static_cast<Eigen::Index>(capacity)) {}

const RowBatch& RowCompression::compress(const RowBatch& batch, double rate_variance) {
  out_.clear();
  const std::vector<RowBlock>& blocks = batch.blocks();
  std::size_t b = 0;
  while (b < blocks.size()) {
    const std::size_t begin = b++;
    const LinearRow& first = batch.rows()[blocks[begin].first];
    while (blocks[begin].count == 1 && b < blocks.size() && blocks[b].count == 1 &&
           alike(first, batch.rows()[blocks[b].first])) {
      ++b;
    }
    const std::size_t first_row = blocks[begin].first;
    const bool shared = rate_variance > 0.0 && blocks[begin].count == 1;
    if ((b - begin > kMaxRank || shared) &&
        compress_run(batch, first_row, first_row + b - begin, rate_variance)) {
      continue;
    }
    for (std::size_t i = begin; i < b; ++i) {
      out_.begin_block();
      for (std::size_t k = 0; k < blocks[i].count; ++k)
        out_.push(batch.rows()[blocks[i].first + k]);
    }
  }
  return out_;
}

bool RowCompression::compress_run(const RowBatch& batch, std::size_t begin, std::size_t end,
                                  double rate_variance) {
  constexpr double kRounding = 1e-24;  // squared rounding error of a row, relative
  const auto m = static_cast<Eigen::Index>(end - begin);
  auto rows = rows_.leftCols(m);
  auto residual = residual_.head(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const LinearRow& row = batch.rows()[begin + static_cast<std::size_t>(i)];
    if (!(row.variance > 0.0)) return false;  // left to the update, which rejects it
    const double weight = 1.0 / std::sqrt(row.variance);
    rows.col(i) = weight * Eigen::Map<const Eigen::Matrix<double, kColumns, 1>>(row.h.data());
    residual[i] = weight * row.residual;
  }
  int rank = 0;
  double enough = 0.0;
  for (;; ++rank) {  // (E1)
    Eigen::Index longest = 0;
    const double square = rows.colwise().squaredNorm().maxCoeff(&longest);
    if (rank == 0) enough = kRounding * square;
    if (!(square > enough)) break;
    if (rank == kMaxRank) return false;
    auto b = basis_.col(rank);
    b = rows.col(longest) / std::sqrt(square);
    for (Eigen::Index i = 0; i < m; ++i) {
      factor_(i, rank) = b.dot(rows.col(i));
      rows.col(i) -= factor_(i, rank) * b;
    }
  }
  Rows compressed;
  LinearRow row = batch.rows()[begin];
  row.variance = 1.0;
  for (int k = 0; k < rank; ++k) {  // (E2)
    auto q = factor_.col(k).head(m);
    const double length = q.norm();
    if (!(length > 0.0)) continue;
    q /= length;
    Eigen::Map<Eigen::Matrix<double, kColumns, 1>> h(row.h.data());
    h = length * basis_.col(k);
    for (int j = k + 1; j < rank; ++j) {
      const double t = q.dot(factor_.col(j).head(m));
      factor_.col(j).head(m) -= t * q;
      h += t * basis_.col(j);
    }
    row.residual = q.dot(residual);
    (void)compressed.push_back(row);
  }
  if (rate_variance > 0.0) whiten(rate_variance, &compressed);
  for (const LinearRow& done : compressed) {
    out_.begin_block();
    out_.push(done);
  }
  return true;
}

void RowCompression::whiten(double rate_variance, Rows* rows) {
  Eigen::Matrix<double, kMaxRank, 3> G = Eigen::Matrix<double, kMaxRank, 3>::Zero();
  for (std::size_t i = 0; i < rows->size(); ++i) {
    (*rows)[i].for_each_segment([&](int column, const double* h, int) {
      if (column == body::kGyroBias) {
        G.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVector3d>(h);
      }
    });
  }
  const Eigen::Matrix<double, kMaxRank, kMaxRank> covariance =
      Eigen::Matrix<double, kMaxRank, kMaxRank>::Identity() + rate_variance * G * G.transpose();
  const SmallCholesky<kMaxRank> root(covariance);
  const auto& L = root.L();
  for (std::size_t i = 0; i < rows->size(); ++i) {  // forward substitution
    LinearRow& row = (*rows)[i];
    Eigen::Map<Eigen::Matrix<double, kColumns, 1>> h(row.h.data());
    for (std::size_t j = 0; j < i; ++j) {
      const double l = L(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      h -= l * Eigen::Map<const Eigen::Matrix<double, kColumns, 1>>((*rows)[j].h.data());
      row.residual -= l * (*rows)[j].residual;
    }
    const double diagonal = L(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
    h /= diagonal;
    row.residual /= diagonal;
  }
}

}  // namespace rio

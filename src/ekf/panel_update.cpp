// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/panel_update.hpp"

#include <array>

#include "rio/core/combine_columns.hpp"
#include "rio/core/symmetric.hpp"

namespace rio {

namespace {

/// A linear combination of columns, by a row of H or over a panel.
class Combination {
 public:
  void add(const double* column, double factor) {
    RIO_ASSERT(count_ < columns_.size());
    columns_[count_] = column;
    factors_[count_++] = factor;
  }
  void sum(Eigen::Index rows, double* out) const {
    combine_columns(count_, columns_.data(), factors_.data(), rows, out);
  }

 private:
  static constexpr std::size_t kMost = 32;

  std::array<const double*, kMost> columns_;
  std::array<double, kMost> factors_;
  std::size_t count_ = 0;
};

}  // namespace

PanelUpdate::PanelUpdate(int capacity)
    : backup_(Eigen::MatrixXd::Zero(capacity, capacity)),
      W_(Eigen::MatrixXd::Zero(capacity, kPanel)),
      diagonal_(Eigen::VectorXd::Zero(capacity)),
      combined_(Eigen::VectorXd::Zero(capacity)) {}

bool PanelUpdate::apply(const RowBatch& batch, Covariance* covariance, Eigen::VectorXd* dx) {
  Eigen::Ref<Eigen::MatrixXd> P = covariance->matrix();
  const Eigen::Index size = P.rows();
  auto backup = backup_.topLeftCorner(size, size);
  const bool several = batch.rows().size() > kPanel;  // a single panel fails before it changes P
  if (several) backup = P;
  dx->head(size).setZero();
  std::size_t block = 0;
  while (block < batch.blocks().size()) {
    if (block > 0) mirror_lower(P);
    const LinearRow* first = &batch.rows()[batch.blocks()[block].first];
    std::size_t rows = 0;
    while (block < batch.blocks().size() && rows + batch.blocks()[block].count <= kPanel) {
      rows += batch.blocks()[block++].count;
    }
    if (!panel(first, static_cast<Eigen::Index>(rows), P, dx)) {
      if (several) P = backup;
      return false;
    }
  }
  return true;
}

bool PanelUpdate::panel(const LinearRow* rows, Eigen::Index m, Eigen::Ref<Eigen::MatrixXd> P,
                        Eigen::VectorXd* dx) {
  const Eigen::Index size = P.rows();
  auto W = W_.topLeftCorner(size, m);
  Eigen::Matrix<double, kPanel, 1> innovation = Eigen::Matrix<double, kPanel, 1>::Zero();
  PanelMatrix S(m, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    const LinearRow& row = rows[k];
    innovation[k] = row.residual;
    Combination of_P;
    row.for_each_segment([&](int column, const double* h, int length) {
      for (int i = 0; i < length; ++i) {
        of_P.add(&P(0, column + i), h[i]);
        innovation[k] -= h[i] * (*dx)[column + i];
      }
    });
    of_P.sum(size, &W(0, k));
    for (Eigen::Index j = 0; j <= k; ++j) {  // S = H W + R, lower triangle
      double s = 0.0;
      row.for_each_segment([&](int column, const double* h, int length) {
        for (int i = 0; i < length; ++i) s += h[i] * W(column + i, j);
      });
      S(k, j) = s;
    }
    S(k, k) += row.variance;
  }
  if (!factorise_in_place(S)) return false;
  for (Eigen::Index k = 0; k < m; ++k) {  // innovation <- L^-1 innovation
    const double before = S.row(k).head(k).dot(innovation.head(k));
    innovation[k] = (innovation[k] - before) / S(k, k);
  }
  solve(S, W);
  auto diagonal = diagonal_.head(size);  // bounds all of P: if it is finite, so is P
  diagonal = P.diagonal();
  for (Eigen::Index k = 0; k < m; ++k) diagonal -= W.col(k).cwiseAbs2();
  dx->head(size).noalias() += W * innovation.head(m);
  if (!diagonal.allFinite() || diagonal.minCoeff() < 0.0 || !dx->head(size).allFinite()) {
    return false;
  }
  for (Eigen::Index c = 0; c < size; ++c) {  // the lower triangle
    Combination of_W;
    for (Eigen::Index k = 0; k < m; ++k) of_W.add(&W(c, k), W(c, k));
    of_W.sum(size - c, combined_.data());
    P.col(c).tail(size - c) -= combined_.head(size - c);
  }
  P.diagonal() = diagonal;
  return true;
}

void PanelUpdate::solve(const PanelMatrix& L, Eigen::Ref<Eigen::MatrixXd> W) {
  auto before = combined_.head(W.rows());
  for (Eigen::Index k = 0; k < W.cols(); ++k) {
    Combination of_W;
    for (Eigen::Index j = 0; j < k; ++j) of_W.add(&W(0, j), L(k, j));
    of_W.sum(W.rows(), before.data());
    W.col(k) = (W.col(k) - before) * (1.0 / L(k, k));
  }
}

}  // namespace rio

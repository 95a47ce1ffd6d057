// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/panel_update.hpp"

#include "rio/core/dense_cholesky.hpp"
#include "rio/core/mirror.hpp"

namespace rio {

PanelUpdate::PanelUpdate(int capacity)
    : backup_(Eigen::MatrixXd::Zero(capacity, capacity)),
      W_(Eigen::MatrixXd::Zero(capacity, kPanel)),
      diagonal_(Eigen::VectorXd::Zero(capacity)) {}

bool PanelUpdate::apply(const RowBatch& batch, Covariance* covariance, Eigen::VectorXd* dx) {
  Eigen::Ref<Eigen::MatrixXd> P = covariance->matrix();
  const Eigen::Index size = P.rows();
  auto backup = backup_.topLeftCorner(size, size);
  const bool several = batch.rows().size() > kPanel;  // one alone fails before it changes anything
  if (several) backup = P;
  dx->head(size).setZero();
  std::size_t block = 0;
  while (block < batch.blocks().size()) {
    const std::size_t begin = block;
    std::size_t rows = 0;
    while (block < batch.blocks().size() && rows + batch.blocks()[block].count <= kPanel) {
      rows += batch.blocks()[block++].count;
    }
    if (!panel(batch, begin, block, static_cast<Eigen::Index>(rows), P, dx)) {
      if (several) P = backup;
      return false;
    }
  }
  return true;
}

bool PanelUpdate::panel(const RowBatch& batch, std::size_t first_block, std::size_t end_block,
                        Eigen::Index m, Eigen::Ref<Eigen::MatrixXd> P, Eigen::VectorXd* dx) {
  const Eigen::Index size = P.rows();
  const std::size_t first = batch.blocks()[first_block].first;
  auto W = W_.topLeftCorner(size, m);
  Eigen::Matrix<double, kPanel, 1> innovation = Eigen::Matrix<double, kPanel, 1>::Zero();
  PanelMatrix S(m, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    const LinearRow& row = batch.rows()[first + static_cast<std::size_t>(k)];
    auto w = W.col(k);
    w.setZero();
    innovation[k] = row.residual;
    row.for_each_segment([&](int column, const double* values, int length) {
      const Eigen::Map<const Eigen::VectorXd> h(values, length);
      w.noalias() += P.middleCols(column, length) * h;
      innovation[k] -= h.dot(dx->segment(column, length));
    });
    for (Eigen::Index j = 0; j <= k; ++j) {  // S = H W, lower triangle
      double s = 0.0;
      row.for_each_segment([&](int column, const double* h, int length) {
        for (int i = 0; i < length; ++i) s += h[i] * W(column + i, j);
      });
      S(k, j) = s;
    }
  }
  add_noise(batch, first_block, end_block, &S);
  if (!factorise_in_place(S)) return false;
  for (Eigen::Index k = 0; k < m; ++k) {  // W <- W L^-T, innovation <- L^-1 innovation
    Eigen::Matrix<double, kPanel, 1> l;
    l.head(k) = S.row(k).head(k).transpose();
    W.col(k).noalias() -= W.leftCols(k) * l.head(k);
    innovation[k] = (innovation[k] - l.head(k).dot(innovation.head(k))) / S(k, k);
    W.col(k) *= 1.0 / S(k, k);
  }
  auto diagonal = diagonal_.head(size);  // bounds all of P: if it is finite, P is
  diagonal = P.diagonal();
  for (Eigen::Index k = 0; k < m; ++k) diagonal -= W.col(k).cwiseAbs2();
  dx->head(size).noalias() += W * innovation.head(m);
  if (!diagonal.allFinite() || diagonal.minCoeff() < 0.0 || !dx->head(size).allFinite()) {
    return false;
  }
  P.selfadjointView<Eigen::Lower>().rankUpdate(W, -1.0);
  P.diagonal() = diagonal;
  mirror_lower(P);
  return true;
}

void PanelUpdate::add_noise(const RowBatch& batch, std::size_t first_block, std::size_t end_block,
                            PanelMatrix* S) {
  Eigen::Index k = 0;
  for (std::size_t b = first_block; b < end_block; ++b) {
    const RowBlock& block = batch.blocks()[b];
    for (std::size_t i = 0; i < block.count; ++i, ++k) {
      (*S)(k, k) += batch.rows()[block.first + i].variance;
    }
  }
}

}  // namespace rio

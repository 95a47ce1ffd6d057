// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/panel_update.hpp"

#include <Eigen/Cholesky>

namespace rio {

PanelUpdate::PanelUpdate(int capacity)
    : backup_(Eigen::MatrixXd::Zero(capacity, capacity)),
      W_(Eigen::MatrixXd::Zero(capacity, kPanel)) {}

bool PanelUpdate::apply(const RowBatch& batch, Covariance* covariance, Eigen::VectorXd* dx) {
  Eigen::Ref<Eigen::MatrixXd> P = covariance->matrix();
  const Eigen::Index size = P.rows();
  auto backup = backup_.topLeftCorner(size, size);
  backup = P;
  dx->head(size).setZero();
  std::size_t block = 0;
  bool ok = true;
  while (ok && block < batch.blocks().size()) {
    const std::size_t begin = block;
    std::size_t rows = 0;
    while (block < batch.blocks().size() && rows + batch.blocks()[block].count <= kPanel) {
      rows += batch.blocks()[block++].count;
    }
    ok = panel(batch, begin, block, static_cast<Eigen::Index>(rows), P, dx);
  }
  ok = ok && dx->head(size).allFinite() && P.allFinite() && P.diagonal().minCoeff() >= 0.0;
  if (!ok) P = backup;
  return ok;
}

bool PanelUpdate::panel(const RowBatch& batch, std::size_t first_block, std::size_t end_block,
                        Eigen::Index m, Eigen::Ref<Eigen::MatrixXd> P, Eigen::VectorXd* dx) {
  const Eigen::Index size = P.rows();
  const std::size_t first = batch.blocks()[first_block].first;
  auto W = W_.topLeftCorner(size, m);
  Eigen::Matrix<double, kPanel, 1> innovation = Eigen::Matrix<double, kPanel, 1>::Zero();
  Eigen::Matrix<double, kPanel, kPanel> S = Eigen::Matrix<double, kPanel, kPanel>::Identity();
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
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(S);
  if (llt.info() != Eigen::Success) return false;
  for (Eigen::Index k = 0; k < m; ++k) {  // W <- W L^-T, innovation <- L^-1 innovation
    const Eigen::Matrix<double, kPanel, 1> l = S.row(k).transpose();
    W.col(k).noalias() -= W.leftCols(k) * l.head(k);
    innovation[k] = (innovation[k] - l.head(k).dot(innovation.head(k))) / l[k];
    W.col(k) /= l[k];
  }
  for (Eigen::Index k = 0; k < m; ++k) dx->head(size) += innovation[k] * W.col(k);
  P.selfadjointView<Eigen::Lower>().rankUpdate(W, -1.0);
  for (Eigen::Index c = 1; c < size; ++c) {
    for (Eigen::Index r = 0; r < c; ++r) P(r, c) = P(c, r);
  }
  return true;
}

void PanelUpdate::add_noise(const RowBatch& batch, std::size_t first_block, std::size_t end_block,
                            Eigen::Matrix<double, kPanel, kPanel>* S) {
  Eigen::Index at = 0;
  for (std::size_t b = first_block; b < end_block; ++b) {
    const RowBlock& block = batch.blocks()[b];
    for (std::size_t i = 0; i < block.count; ++i) {
      const auto k = at + static_cast<Eigen::Index>(i);
      (*S)(k, k) += batch.rows()[block.first + i].variance;
      for (Eigen::Index j = at; j < k; ++j) (*S)(k, j) += block.shared_variance;
    }
    at += static_cast<Eigen::Index>(block.count);
  }
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Example 6: a back-end of your own. This one is the Kalman filter with its update written down
// plainly with Eigen (Joseph form, one update for the whole scan); all else it has from rio::Ekf.
// It flies the same path as the library's, which works in panels and allocates nothing.
#include <cstdio>

#include <Eigen/Cholesky>

#include <rio/ekf/ekf.hpp>
#include <rio/pipeline.hpp>

#include "research_flight.hpp"

namespace {

class PlainEkf : public rio::Ekf {
 public:
  using Ekf::Ekf;

  rio::Status update(const rio::Observations& /*seen*/, const rio::ScanRows& rows) {
    using Eigen::MatrixXd;
    const MatrixXd P = state_estimate().covariance().matrix();
    const rio::RowBatch& batch = rows.batch();
    const auto count = static_cast<Eigen::Index>(batch.rows().size());
    MatrixXd H = MatrixXd::Zero(count, P.cols());
    MatrixXd R = MatrixXd::Zero(count, count);
    Eigen::VectorXd r(count);
    // the Dopplers of points, blocks of one row, share the noise of the gyro sample, which has the
    // coefficients of the gyro bias (models/doppler.hpp)
    MatrixXd shared = MatrixXd::Zero(count, 3);
    for (const rio::RowBlock& block : batch.blocks()) {
      for (std::size_t k = block.first; k < block.first + block.count; ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        const rio::LinearRow& row = batch.rows()[k];
        row.for_each_segment([&](int column, const double* h, int length) {
          H.row(i).segment(column, length) = Eigen::Map<const Eigen::RowVectorXd>(h, length);
        });
        R(i, i) = row.variance;
        r[i] = row.residual;
        if (block.count == 1) shared.row(i) = H.row(i).segment<3>(rio::body::kGyroBias);
      }
    }
    R += estimate().gyro_variance * shared * shared.transpose();
    const Eigen::LLT<MatrixXd> S(H * P * H.transpose() + R);
    if (S.info() != Eigen::Success) return rio::Status::kNumerical;
    MatrixXd K = S.solve(H * P).transpose();
    // considered, not estimated (Schmidt); the form of Joseph holds for any gain
    const rio::Layout& layout = state_estimate().layout();
    if (layout.has_elevation_error()) K.row(layout.elevation_error()).setZero();
    const MatrixXd I_KH = MatrixXd::Identity(P.rows(), P.cols()) - K * H;
    const MatrixXd updated = I_KH * P * I_KH.transpose() + K * R * K.transpose();
    Eigen::VectorXd dx = Eigen::VectorXd::Zero(state_estimate().layout().capacity());
    dx.head(P.rows()) = K * r;
    replace(
        [&](rio::StateEstimate* x) {
          x->covariance().matrix() = 0.5 * (updated + updated.transpose());
          x->correct(dx);
        },
        rio::Invalidates::kNothing, nullptr);
    return rio::Status::kOk;
  }
};

}  // namespace

int main() {
  ResearchFlight research;
  research.options.update.consistent_covariance = false;  // a step of its own in rio::Ekf
  rio::Pipeline<rio::Ekf> library(research.options);
  rio::Pipeline<PlainEkf> own(research.options);
  std::printf("at the end of 30 m: %.4f m off", fly(research, &library));
  std::printf(", with the plain update %.4f m\n", fly(research, &own));
  const double apart = (library.estimate().nav.p_WB - own.estimate().nav.p_WB).norm();
  std::printf("the two are %.1e m apart\n", apart);
  return apart < 1e-6 ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
// The update of the Doppler scale with a velocity predicted by a rough IMU: without bias, because
// its Jacobian is that at the steady motion ((E7) of models/doppler.hpp).
#include <gtest/gtest.h>

#include <cmath>

#include "support/random_state.hpp"
#include "support/scan_case.hpp"
#include "support/symmetric.hpp"

namespace rio {
namespace {

constexpr double kScaleSigma = 0.005;
constexpr int kScans = 4000;

class ScaleBias : public test::ScanCase {
 protected:
  ScaleBias() {
    options_.calibration.doppler_scale_sigma = kScaleSigma;
    options_.update.gate_probability = 1.0;
    see({4.0, -1.5, -1.0});
    see({2.0, 2.0, 0.5});
    truth_ = scan_;
  }

  /// Dopplers with new noise.
  void measure() {
    scan_ = truth_;
    for (Detection& d : scan_.items) d.range_rate += random_.normal(d.sigma_doppler);
  }

  /// The correction of the scale by one scan.
  double correction(bool steady) {
    StateEstimate b(options_, options_.update.max_clones);
    NavState nav;
    nav.time = test::kStart;
    nav.v_WB =
        Vector3d(test::kSpeed, 0.0, 0.0) + random_.normal_vector(std::sqrt(test::kVelocityVar));
    BodyCovariance P = 1e-8 * BodyCovariance::Identity();
    P.block<3, 3>(body::kVelocity, body::kVelocity) = test::kVelocityVar * Matrix3d::Identity();
    b.reset(nav, P);
    if (steady) b.estimate().steady.v_B = Vector3d(test::kSpeed, 0.0, 0.0);
    ScanRows rows(options_);
    const RowBatch& batch = build(rows, b);
    const auto n = static_cast<Eigen::Index>(batch.rows().size());
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, b.covariance().size());
    Eigen::VectorXd r(n);
    Eigen::VectorXd variances(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const LinearRow& row = batch.rows()[static_cast<std::size_t>(i)];
      row.for_each_segment([&](int column, const double* h, int length) {
        for (int k = 0; k < length; ++k) H(i, column + k) = h[k];
      });
      r[i] = row.residual;
      variances[i] = row.variance;
    }
    const int scale = b.layout().doppler_scale();
    prior_variance_ = b.covariance().matrix()(scale, scale);
    const Eigen::MatrixXd PHt = b.covariance().matrix() * H.transpose();
    const Eigen::MatrixXd S = H * PHt + Eigen::MatrixXd(variances.asDiagonal());
    return PHt.row(scale).dot(test::solve(S, r).col(0));
  }

  struct Mean {
    double value = 0.0;
    double sigma = 0.0;  ///< of the value
  };
  Mean mean_correction(bool steady) {
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < kScans; ++i) {
      measure();
      const double c = correction(steady);
      sum += c;
      squares += c * c;
    }
    const double mean = sum / kScans;
    return {mean, std::sqrt((squares / kScans - mean * mean) / kScans)};
  }

  DetectionList truth_;
  double prior_variance_ = 0.0;
  test::Random random_{7};
};

TEST_F(ScaleBias, TheErrorOfThePredictedVelocityDoesNotMoveTheScale) {
  const Mean steady = mean_correction(true);
  EXPECT_LT(std::abs(steady.value), 3.0 * steady.sigma);
  // at the prediction itself: one prior variance for each axis of the velocity
  const Mean predicted = mean_correction(false);
  EXPECT_NEAR(predicted.value, -3.0 * prior_variance_, 4.0 * predicted.sigma);
  EXPECT_LT(predicted.value, -10.0 * predicted.sigma);
}

}  // namespace
}  // namespace rio

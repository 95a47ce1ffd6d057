// SPDX-License-Identifier: BSD-3-Clause
// Dopplers that share the noise of a gyro sample: against dense matrices.
#include "rio/smoother/scan_information.hpp"

#include <gtest/gtest.h>

#include "rio/models/landmark_point.hpp"
#include "support/dense_rows.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

constexpr double kRateVariance = 0.02;  // [rad^2/s^2]
constexpr int kPoints = 12;

/// A turning body with a radar on a long arm that sees points and a landmark.
class ScanInformationTest : public testing::Test {
 protected:
  ScanInformationTest() {
    Random random(11);
    x_.nav = random.state();
    x_.gyro_B = random.normal_vector(0.5);
    x_.T_BS = {random.rotation(), random.normal_vector(0.5)};
    const LinearizationPoint x(x_);
    for (int i = 0; i < kPoints; ++i) {
      const Vector3d point_S = 4.0 * random.direction();
      const double rate = -x.radar_velocity_S().dot(point_S.normalized()) + random.normal(0.1);
      points_.push_back(make_detection({point_S, rate}, RadarOptions{}));
    }
    LandmarkState landmark;
    const Vector3d point_S = points_[0].range * points_[0].direction_S;
    landmark.p_W = x.T_WB.R * (x.T_BS.R * point_S + x.T_BS.p) + x.T_WB.p;
    x_.landmarks.push_back(landmark);
  }
  template <class M>
  void push(const M& model, const typename M::Measurement& z, int landmark_column = -1) {
    ASSERT_TRUE(scan_.push(model, z, typename M::Blocks{}, LinearizationPoint(x_), {0, 0}));
    scan_.close(1.0, landmark_column);
  }
  DopplerModel::Measurement doppler(int i) const {
    return DopplerModel::measurement(points_[static_cast<std::size_t>(i)], x_.gyro_B);
  }
  /// The rows of the points, each a block.
  RowBatch rows() const {
    RowBatch batch(kPoints);
    for (int i = 0; i < kPoints; ++i) {
      batch.begin_block();
      EXPECT_TRUE(linearize(model_, doppler(i), DopplerModel::Blocks{}, LinearizationPoint(x_),
                            {0, 0}, layout_, &batch));
    }
    return batch;
  }
  MatrixXd H() const { return MatrixXd(system_.H()).selfadjointView<Eigen::Lower>(); }

  Estimate x_;
  std::vector<Detection> points_;
  DopplerModel model_{DopplerDirections::kNoisy};
  WindowLayout layout_{Layout{{0.05, 0.03, 0.02, 0.02, 0.03}, 0, 1}, 1, 0};
  NormalEquations system_{1, 12};
  ScanInformation scan_{SmootherOptions{}, &system_};
};

TEST_F(ScanInformationTest, SharedNoiseIsTheDenseCovarianceOfTheDopplers) {
  system_.clear(1, 12);
  scan_.begin(layout_);
  for (int i = 0; i < kPoints; ++i) push(model_, doppler(i));
  scan_.share_rate_noise(kRateVariance);
  const double cost = scan_.end();
  const int n = system_.size();
  DenseRows expected = dense_rows(rows().rows(), n);
  const MatrixXd independent = expected.information();
  const MatrixXd G = expected.H.middleCols<3>(body::kGyroBias);
  expected.R += kRateVariance * G * G.transpose();
  const MatrixXd shared = expected.information();
  const double size = shared.leftCols(n).cwiseAbs().maxCoeff();
  EXPECT_LT((H() - shared.leftCols(n)).cwiseAbs().maxCoeff(), 1e-9 * size);
  EXPECT_GT((independent - shared).leftCols(n).cwiseAbs().maxCoeff(), 0.1 * size);
  EXPECT_LT((VectorXd(system_.g()) - shared.col(n)).norm(), 1e-9 * system_.g().norm());
  EXPECT_NEAR(cost, 0.5 * expected.r.dot(solve(expected.R, expected.r).col(0)), 1e-9 * cost);
}

// The noise is not shared with what follows, and no noise changes nothing.
TEST_F(ScanInformationTest, OnlyTheMeasurementsBeforeShareIt) {
  const auto sum = [&](double variance, bool doppler_first, bool landmark) {
    system_.clear(1, 12);
    scan_.begin(layout_);
    if (doppler_first) {
      for (int i = 0; i < kPoints; ++i) push(model_, doppler(i));
    }
    scan_.share_rate_noise(variance);
    if (landmark) {
      push(LandmarkDopplerModel(), LandmarkDopplerModel::measurement(points_[0], x_.gyro_B),
           layout_.column<Landmark>(0));
    }
    (void)scan_.end();
    return H();
  };
  const MatrixXd both = sum(kRateVariance, true, true);
  const MatrixXd expected = sum(kRateVariance, true, false) + sum(0.0, false, true);
  EXPECT_LT((both - expected).norm(), 1e-9 * both.norm());
  EXPECT_GT((sum(0.0, true, true) - both).norm(), 0.01 * both.norm());
}

}  // namespace
}  // namespace rio::test

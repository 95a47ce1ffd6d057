// SPDX-License-Identifier: BSD-3-Clause
// What happens to a model's rows on their way into the update: the derivatives of a state stepped
// back and of a time offset against central differences, the columns.
#include "rio/update/linearize.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/models/doppler.hpp"
#include "rio/models/landmark_point.hpp"
#include "rio/models/trail_distance.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

/// A body in motion that sees a landmark; two clones, two landmarks, everything estimated.
class RowsOfAModel : public testing::Test {
 protected:
  RowsOfAModel() {
    Random random(7);
    x_.nav = random.state();
    x_.gyro_B = random.normal_vector();
    x_.steady.accel_W = random.normal_vector(2.0);
    x_.T_BS = {random.rotation(), random.normal_vector(0.5)};
    x_.landmarks.push_back({x_.nav.p_WB + Vector3d(9.0, 0.0, 0.0)});
    x_.landmarks.push_back({x_.nav.p_WB + Vector3d(3.0, -4.0, 1.0)});
    x_.clones.push_back({5, {Matrix3d::Identity(), Vector3d(1.0, 2.0, 3.0)}});
    x_.clones.push_back({6, {x_.T_WB().R, x_.nav.p_WB - Vector3d(0.3, 0.2, 0.1)}});
    const ObservedPoint point(x_.T_WB(), RigidPose(x_.T_BS), x_.landmarks[1].p_W);
    detection_ = make_detection({.point_S = point.e_S + Vector3d(0.1, -0.1, 0.05)}, RadarOptions{});
  }
  /// The row i of a model at the state `seconds` earlier.
  template <MeasurementModel M>
  LinearRow row(const M& model, const typename M::Measurement& z, std::size_t i = 0,
                double seconds = 0.0) const {
    LinearizationPoint x(x_);
    x.step_back(seconds);
    return row_at(x, model, z, i);
  }
  template <MeasurementModel M>
  LinearRow row_at(const LinearizationPoint& x, const M& model, const typename M::Measurement& z,
                   std::size_t i = 0) const {
    RowBatch batch(8);
    batch.begin_block();
    EXPECT_TRUE(linearize(model, z, typename M::Blocks{}, x, {1, 1}, layout_, &batch));
    EXPECT_EQ(batch.last_block().count, static_cast<std::size_t>(M::kDim));
    return batch.rows()[i];
  }
  double by_time_offset(const LinearRow& row) const {
    double d = std::nan("");
    row.for_each_segment([&](int column, const double* h, int) {
      if (column == layout_.time_offset()) d = h[0];
    });
    return d;
  }
  /// The column of the time offset against central differences (E1). The noise must not change with
  /// the state: it whitens.
  template <MeasurementModel M>
  void expect_time_derivative(const M& model, const typename M::Measurement& z) const {
    constexpr double kStep = 1e-5;
    for (std::size_t i = 0; i < static_cast<std::size_t>(M::kDim); ++i) {
      const double d = by_time_offset(row(model, z, i));
      const double later = row(model, z, i, kStep).residual;
      const double earlier = row(model, z, i, -kStep).residual;
      EXPECT_NEAR(d, (earlier - later) / (2.0 * kStep), 1e-6 * (1.0 + std::abs(d))) << i;
      EXPECT_GT(std::abs(d), 0.01);
    }
  }

  CalibrationOptions calibration_{0.05, 0.03, 0.03, 0.02, 0.03};
  Layout layout_{calibration_, 2, 2};
  Estimate x_;
  Detection detection_;
};

TEST_F(RowsOfAModel, AStateSteppedBackHasTheDerivativeItSays) {
  constexpr double kSeconds = 0.1;
  constexpr double kStep = 1e-5;
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const NavState nav = random.state();
    const Vector3d gyro_B = random.normal_vector();
    const Vector3d accel_B = random.normal_vector(2.0);
    const auto stepped_back = [&](const BodyVector& error) {
      const NavState x = perturbed(nav, error);
      SteadyMotion steady;
      steady.accel_W = x.q_WB * accel_B;
      LinearizationPoint point(x_, x, gyro_B, steady);
      point.step_back(kSeconds);
      return point;
    };
    const LinearizationPoint at = stepped_back(BodyVector::Zero());
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(9, 12);  // (E2)
    expected.block<3, 3>(0, 0) = at.step.attitude;
    expected.block<3, 3>(0, 9) = at.step.bias;
    expected.block<3, 3>(3, 3).setIdentity();
    expected.block<3, 3>(3, 6) = -at.step.seconds * Matrix3d::Identity();
    expected.block<3, 3>(6, 0) = at.step.velocity;
    expected.block<3, 3>(6, 6).setIdentity();
    for (int k = 0; k < 12; ++k) {
      const LinearizationPoint plus = stepped_back(kStep * BodyVector::Unit(k));
      const LinearizationPoint minus = stepped_back(-kStep * BodyVector::Unit(k));
      Eigen::VectorXd difference(9);
      difference << quaternion_log(Quaternion(Matrix3d(minus.T_WB.R.transpose() * plus.T_WB.R))),
          plus.T_WB.p - minus.T_WB.p, plus.v_WB - minus.v_WB;
      // kStep squared times third derivatives, and rounding 1e-15 / kStep
      EXPECT_LT((difference / (2.0 * kStep) - expected.col(k)).norm(), 1e-8) << k;
    }
  }
}

TEST_F(RowsOfAModel, ATimeOffsetMovesTheStateAlongItsMotion) {
  expect_time_derivative(LandmarkPointModel{}, LandmarkPointModel::measurement(detection_));
  // its noise without, its Jacobian with the direction as measured
  expect_time_derivative(DopplerModel(DopplerDirections::kExact),
                         DopplerModel::measurement(detection_, x_.gyro_B));
  expect_time_derivative(TrailDistanceModel(0.1),
                         TrailDistanceModel::measurement(detection_, detection_));
}

TEST_F(RowsOfAModel, OfAStandingBodyATimeOffsetTellsNothing) {
  LinearizationPoint x(x_);
  x.stand();
  const LinearRow doppler = row_at(x, DopplerModel(DopplerDirections::kExact),
                                   DopplerModel::measurement(detection_, x_.gyro_B));
  EXPECT_EQ(by_time_offset(doppler), 0.0);
}

TEST_F(RowsOfAModel, BlocksStandInTheirColumns) {
  const auto columns = [](const LinearRow& row) {
    std::vector<int> all;
    row.for_each_segment([&](int column, const double*, int) { all.push_back(column); });
    return all;
  };
  using Columns = std::vector<int>;
  const LinearRow trail =
      row(TrailDistanceModel(0.1), TrailDistanceModel::measurement(detection_, detection_));
  EXPECT_EQ(columns(trail),
            (Columns{0, layout_.clone(1), layout_.extrinsics(), layout_.time_offset()}));
  EXPECT_NEAR(trail.variance, 0.01, 1e-15);
  const LinearRow point = row(LandmarkPointModel{}, LandmarkPointModel::measurement(detection_), 2);
  EXPECT_EQ(columns(point), (Columns{0, layout_.extrinsics(), layout_.landmark(1),
                                     layout_.elevation_error(), layout_.time_offset()}));
  EXPECT_EQ(point.variance, 1.0);  // whitened
}

// Seen from the other clone or landmark the residual is another one.
TEST_F(RowsOfAModel, ValuesAreThoseOfTheIndex) {
  const LinearizationPoint x(x_);
  EXPECT_EQ(block_value<ClonePose>(x, {1, 0}).p, x_.clones[1].T_WB.p);
  EXPECT_EQ(block_value<Landmark>(x, {0, 1}), x_.landmarks[1].p_W);
  EXPECT_EQ(block_value<GyroBias>(x, {}), x_.nav.gyro_bias);
  EXPECT_EQ(x.radar_velocity_S(), radar_velocity(x_));
}

TEST_F(RowsOfAModel, TheSteadyOffsetIsTheChangeOfTheMotion) {
  x_.steady.v_B = Vector3d(1.0, -2.0, 0.5);
  x_.steady.rate_B = Vector3d(0.3, 0.1, -0.4);
  Estimate steady = x_;
  steady.nav.v_WB = x_.nav.q_WB * x_.steady.v_B;
  steady.gyro_B = x_.nav.gyro_bias + x_.steady.rate_B;
  const SteadyOffset offset = LinearizationPoint(x_).steady_offset();
  EXPECT_LT((offset.velocity_S - radar_velocity(steady) + radar_velocity(x_)).norm(), 1e-12);
  EXPECT_LT((offset.rate_B - steady.gyro_B + x_.gyro_B).norm(), 1e-12);
}

}  // namespace
}  // namespace rio::test

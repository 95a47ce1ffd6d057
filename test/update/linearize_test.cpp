// SPDX-License-Identifier: BSD-3-Clause
// What happens to a model's rows on their way into the update: whitening against the Cholesky
// factor of Eigen, the derivatives of a state stepped back and of a time offset against central
// differences, the columns.
#include "rio/update/linearize.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/models/doppler.hpp"
#include "rio/models/landmark_point.hpp"
#include "rio/models/trail_distance.hpp"
#include "support/dense_rows.hpp"
#include "support/random_state.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

TEST(Whiten, IsTheInverseOfTheCholeskyFactor) {
  constexpr int kDim = 4;
  constexpr int kDof = 7;
  sim::Random random(3);
  for (int i = 0; i < 20; ++i) {
    const MatrixXd root = random_matrix(random, kDim, kDim);
    const JacobianOf<kDim, kDim> R = root * root.transpose() + MatrixXd::Identity(kDim, kDim);
    const ResidualOf<kDim> r = random_matrix(random, kDim, 1);
    const JacobianOf<kDim, kDof> J = random_matrix(random, kDim, kDof);
    const MatrixXd W = whitening(R);
    const ResidualOf<kDim> expected_r = W * r;
    const JacobianOf<kDim, kDof> expected_J = W * J;
    const SmallCholesky<kDim> cholesky(R);
    EXPECT_LT((cholesky.whitened(r) - expected_r).norm(), 1e-12);
    EXPECT_LT((cholesky.whitened(J) - expected_J).norm(), 1e-12);
  }
}

/// A body in motion.
struct MovingBody {
  explicit MovingBody(Random& random)
      : nav(random.state()), gyro_B(random.normal_vector()), accel_B(random.normal_vector(2.0)) {}

  /// @param error the body is looked at with
  LinearizationPoint stepped_back(const BodyVector& error, double seconds) const {
    static const Estimate kEstimate;
    const NavState x = perturbed(nav, error);
    SteadyMotion steady;
    steady.accel_W = x.q_WB * accel_B;
    LinearizationPoint point(kEstimate, x, gyro_B, steady);
    point.step_back(seconds);
    return point;
  }

  NavState nav;
  Vector3d gyro_B;
  Vector3d accel_B;
};

TEST(StepBack, HasTheDerivativeItSays) {
  constexpr double kSeconds = 0.1;
  constexpr double kStep = 1e-5;
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const MovingBody motion(random);
    const LinearizationPoint at = motion.stepped_back(BodyVector::Zero(), kSeconds);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(9, 12);  // (E2)
    expected.block<3, 3>(0, 0) = at.step.attitude;
    expected.block<3, 3>(0, 9) = at.step.bias;
    expected.block<3, 3>(3, 3).setIdentity();
    expected.block<3, 3>(3, 6) = -at.step.seconds * Matrix3d::Identity();
    expected.block<3, 3>(6, 0) = at.step.velocity;
    expected.block<3, 3>(6, 6).setIdentity();
    for (int k = 0; k < 12; ++k) {
      const BodyVector error = kStep * BodyVector::Unit(k);
      const LinearizationPoint plus = motion.stepped_back(error, kSeconds);
      const LinearizationPoint minus = motion.stepped_back(-error, kSeconds);
      Eigen::VectorXd difference(9);
      difference << quaternion_log(Quaternion(Matrix3d(minus.T_WB.R.transpose() * plus.T_WB.R))),
          plus.T_WB.p - minus.T_WB.p, plus.v_WB - minus.v_WB;
      // kStep squared times third derivatives, and rounding 1e-15 / kStep
      EXPECT_LT((difference / (2.0 * kStep) - expected.col(k)).norm(), 1e-8) << k;
    }
  }
}

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
    const Vector3d seen_S = point.e_S + Vector3d(0.1, -0.1, 0.05);
    detection_ = make_detection({.point_S = seen_S}, RadarOptions{});
  }
  /// The row i of a model at the state `seconds` earlier.
  template <MeasurementModel M>
  LinearRow row(const M& model, const typename M::Measurement& z, std::size_t i = 0,
                double seconds = 0.0) const {
    LinearizationPoint x(x_);
    x.step_back(seconds);
    RowBatch batch(8);
    batch.begin_block();
    EXPECT_TRUE(linearize(model, z, typename M::Blocks{}, x, {1, 1}, layout_, &batch));
    EXPECT_EQ(batch.last_block().count, static_cast<std::size_t>(M::kDim));
    return batch.rows()[i];
  }
  /// The column of the time offset against central differences (E1). The noise must not change with
  /// the state: it whitens.
  template <MeasurementModel M>
  void expect_time_derivative(const M& model, const typename M::Measurement& z) const {
    constexpr double kStep = 1e-5;
    for (std::size_t i = 0; i < static_cast<std::size_t>(M::kDim); ++i) {
      double d = std::nan("");
      const LinearRow here = row(model, z, i);
      here.for_each_segment([&](int column, const double* h, int) {
        if (column == layout_.time_offset()) d = h[0];
      });
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
  RowBatch batch(1);
  batch.begin_block();
  ASSERT_TRUE(linearize(DopplerModel(DopplerDirections::kExact),
                        DopplerModel::measurement(detection_, x_.gyro_B), DopplerModel::Blocks{}, x,
                        {}, layout_, &batch));
  batch.rows()[0].for_each_segment([&](int column, const double* h, int) {
    if (column == layout_.time_offset()) {
      EXPECT_EQ(h[0], 0.0);
    }
  });
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

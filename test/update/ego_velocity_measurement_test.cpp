// SPDX-License-Identifier: BSD-3-Clause
// The velocity of a scan as one measurement (Doer and Trommer 2020).
#include "rio/update/ego_velocity_measurement.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "rio/update/aiding.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

/// A moving and turning body with a radar on a lever that sees static points.
class EgoVelocityMeasurementTest : public testing::Test {
 protected:
  EgoVelocityMeasurementTest() {
    Random random(5);
    x_.nav = random.state();
    x_.gyro_B = random.normal_vector(0.5) + x_.nav.gyro_bias;
    x_.gyro_variance = 1e-4;
    x_.T_BS = {random.rotation(), random.normal_vector(0.3)};
    set_.v_S = radar_velocity(x_);
    set_.valid = true;
    set_.covariance = Matrix3d::Identity();
    for (std::size_t i = 0; i < 12; ++i) {
      Detection d;
      d.direction_S = (Vector3d(1.5, 0.0, 0.0) + random.normal_vector(0.5)).normalized();
      d.sigma_doppler = 0.03;
      d.range_rate = -d.direction_S.dot(set_.v_S) + random.normal(0.2);
      scan_.items.push_back(d);
      set_.range_rate[i] = d.range_rate;
      set_.inlier[i] = i > 1;  // the first two are outliers
    }
    set_.inliers = 10;
  }

  Estimate x_;
  DetectionList scan_;
  EgoVelocity set_;
};

TEST_F(EgoVelocityMeasurementTest, TheCovarianceIsThatOfTheResiduals) {
  Eigen::Matrix<double, 10, 3> U;
  Eigen::Matrix<double, 10, 1> e;
  for (int i = 0; i < 10; ++i) {
    const Detection& d = scan_.items[static_cast<std::size_t>(i) + 2];
    U.row(i) = d.direction_S.transpose();
    e[i] = d.range_rate + d.direction_S.dot(set_.v_S);
  }
  const Matrix3d expected = e.squaredNorm() / 7.0 * (U.transpose() * U).inverse();
  const std::optional<Matrix3d> covariance = residual_covariance(scan_, set_);
  ASSERT_TRUE(covariance);
  EXPECT_LT((*covariance - expected).norm(), 1e-12 * expected.norm());
  // points that agree by chance: no better than the Doppler noise
  for (std::size_t i = 0; i < 12; ++i) {
    set_.range_rate[i] = -scan_.items[i].direction_S.dot(set_.v_S);
  }
  const Matrix3d least = 0.03 * 0.03 * (U.transpose() * U).inverse();
  EXPECT_LT((*residual_covariance(scan_, set_) - least).norm(), 1e-12 * least.norm());
}

TEST_F(EgoVelocityMeasurementTest, NoneWithoutAConsensusOrWithThreePoints) {
  EXPECT_TRUE(ego_velocity_measurement(scan_, set_, x_));
  EgoVelocity others[] = {set_, set_, set_};
  others[0].valid = false;
  others[1].covariance.reset();
  others[2].inliers = 3;
  for (const EgoVelocity& other : others) {
    EXPECT_FALSE(ego_velocity_measurement(scan_, other, x_));
  }
}

TEST_F(EgoVelocityMeasurementTest, TheVelocityOfTheRadarHasNoResidual) {
  AidingRows rows;
  const std::optional<AidingMeasurement> z = ego_velocity_measurement(scan_, set_, x_);
  ASSERT_TRUE(z);
  EXPECT_EQ(z->time(), x_.nav.time);
  const auto residual = [&](const NavState& nav) {
    EXPECT_TRUE(linearize(*z, {}, nav, x_, {}, 9.81, {}, &rows));
    double sum = 0.0;
    for (const LinearRow& row : rows) sum += row.residual * row.residual;
    return std::sqrt(sum);
  };
  EXPECT_LT(residual(x_.nav), 1e-9);
  // in sigmas of the velocity, the noise of the gyro on the lever included
  const Vector3d off(0.3, -0.2, 0.1);
  NavState other = x_.nav;
  other.v_WB += other.q_WB * off;
  const Matrix3d R_BS = x_.T_BS.rotation.toRotationMatrix();
  const Matrix3d lever = skew(x_.T_BS.translation);
  const Matrix3d S = R_BS * *residual_covariance(scan_, set_) * R_BS.transpose() +
                     x_.gyro_variance * lever * lever.transpose();
  EXPECT_NEAR(residual(other), std::sqrt(off.dot(S.inverse() * off)), 1e-9);
}

}  // namespace
}  // namespace rio::test

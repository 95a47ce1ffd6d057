// SPDX-License-Identifier: BSD-3-Clause
// Measurements made of radar points: the columns of the calibration of one of two radars, and the
// velocity of a scan as one measurement (Doer and Trommer 2020).
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>

#include "rio/models/doppler.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/aiding.hpp"
#include "rio/update/ego_velocity_measurement.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

struct RateOffset : AuxiliaryBlock<2> {
  static constexpr const char* kName = "rate_offset";
  static constexpr double kSigma = 1.0;
  static constexpr double kWalk = 0.0;
};

/// The Doppler of the library as an external model, with an offset of the range rates.
struct OffsetDoppler {
  static constexpr const char* kName = "offset_doppler";
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, BodyVelocity, RateOffset, GyroBias, Extrinsics, DopplerScale>;
  using Measurement = DopplerModel::Measurement;
  bool evaluate(const Measurement& z, const RigidPose& T_WB, const Vector3d& v_WB,
                const RateOffset::Value& offset, const Vector3d& gyro_bias, const RigidPose& T_BS,
                double scale, ResidualOf<1>& r, JacobianOf<1, 21>* J, JacobianOf<1, 1>& R) const {
    JacobianOf<1, 19> inner;
    const bool valid = DopplerModel(DopplerDirections::kExact)
                           .evaluate(z, T_WB, v_WB, gyro_bias, T_BS, scale, r, &inner, R);
    r[0] -= offset.sum();
    *J << inner.leftCols<9>(), 1.0, 1.0, inner.rightCols<10>();
    return valid;
  }
};

class AidingRadarBlocksTest : public testing::Test {
 protected:
  AidingRadarBlocksTest() {
    EXPECT_TRUE(states.declare<RateOffset>());
    x.nav = random.state();
    x.auxiliary.head<2>() << 0.3, -0.1;
    for (std::size_t r = 0; r < 2; ++r) {
      x.set_radar(r, {{random.rotation(), random.normal_vector(0.3)}, 0.02 * random.normal(), 0.0});
    }
    z.range_rate = 0.7;
    z.sigma_doppler = 0.2;
    z.direction_S = random.direction();
    z.gyro_B = random.normal_vector(0.5);
  }
  /// The row of the measurement by radar 1, `since` before the state.
  LinearRow row(const Layout& layout, const ImuIncrements& since = {}) {
    const AidingMeasurement measurement(x.nav.time, OffsetDoppler{}, z, 1);
    AidingRows rows;
    EXPECT_TRUE(linearize(measurement, since, x.nav, x, states, 9.81,
                          aiding_columns(layout.of_radar(1)), &rows));
    EXPECT_EQ(rows.size(), 1U);
    return rows[0];
  }
  /// All columns of a row in the error state.
  static Eigen::VectorXd dense(const LinearRow& row, const Layout& layout) {
    Eigen::VectorXd h = Eigen::VectorXd::Zero(layout.size(0));
    row.for_each_segment([&](int column, const double* values, int length) {
      h.segment(column, length) += Eigen::Map<const Eigen::VectorXd>(values, length);
    });
    return h;
  }
  static CalibrationOptions estimated(double mounting, double doppler_scale) {
    CalibrationOptions c;
    c.rotation_sigma = c.translation_sigma = c.time_offset_sigma = mounting;
    c.elevation_sigma = mounting;
    c.doppler_scale_sigma = doppler_scale;
    return c;
  }

  Random random{3};
  AuxiliaryStates states;
  Estimate x;
  DopplerModel::Measurement z;
};

TEST_F(AidingRadarBlocksTest, ColumnsMatchCentralDifferences) {
  const Layout layout(estimated(0.1, 0.1), 0, 0, states.size(), 2);
  const Layout own = layout.of_radar(1);
  ImuIncrements since;
  since.seconds = 0.02;
  const Eigen::VectorXd h = dense(row(layout, since), layout);
  constexpr double kStep = 1e-5;
  const RadarState radar = x.of_radar(1);
  const auto residual = [&](int column, double step) {
    RadarState moved = radar;
    Estimate kept = x;
    if (column < own.doppler_scale()) {
      Eigen::Matrix<double, 6, 1> error = Eigen::Matrix<double, 6, 1>::Zero();
      error[column - own.extrinsics()] = step;
      const RigidPose T = Extrinsics::retract(RigidPose(radar.T_BS), error);
      moved.T_BS = {Quaternion(T.R), T.p};
    } else if (column == own.doppler_scale()) {
      moved.doppler_scale += step;
    } else {
      x.auxiliary[column - own.auxiliary()] += step;
    }
    x.set_radar(1, moved);
    const double r = row(layout, since).residual;
    x = kept;
    return r;
  };
  for (int column = own.extrinsics(); column < layout.size(0); ++column) {
    if (column == own.time_offset() || column == own.elevation_error()) continue;
    const double numeric = (residual(column, kStep) - residual(column, -kStep)) / (2.0 * kStep);
    // residual = z - h(x)
    EXPECT_NEAR(h[column], -numeric, 1e-6) << column;
    EXPECT_NE(h[column], 0.0) << column;
  }
  EXPECT_EQ(h.segment(layout.of_radar(0).extrinsics(), own.extrinsics() - body::kSize).norm(), 0.0);
  EXPECT_EQ(h[own.time_offset()], 0.0);
  EXPECT_EQ(h[own.elevation_error()], 0.0);
}

TEST_F(AidingRadarBlocksTest, WhatIsNotEstimatedHasNoColumn) {
  const Layout all(estimated(0.1, 0.1), 0, 0, states.size(), 2);
  const Layout none(estimated(0.0, 0.0), 0, 0, states.size(), 2);
  const Layout some(estimated(0.0, 0.1), 0, 0, states.size(), 2);
  const Eigen::VectorXd with = dense(row(all), all);
  for (const Layout* layout : {&none, &some}) {
    const Layout own = layout->of_radar(1);
    const LinearRow without = row(*layout);
    without.for_each_segment([](int column, const double*, int) { ASSERT_GE(column, 0); });
    const Eigen::VectorXd h = dense(without, *layout);
    EXPECT_EQ(h.size(), body::kSize + 2 + (own.has_doppler_scale() ? 2 : 0));
    EXPECT_EQ(without.residual, row(all).residual);
    EXPECT_EQ(h.head(body::kSize), with.head(body::kSize));
    EXPECT_EQ(h.tail(2), with.tail(2));
    if (own.has_doppler_scale()) {
      EXPECT_EQ(h[own.doppler_scale()], with[all.of_radar(1).doppler_scale()]);
    }
  }
}

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
  EgoVelocity other = set_;
  other.valid = false;
  EXPECT_FALSE(ego_velocity_measurement(scan_, other, x_));
  other = set_;
  other.covariance.reset();
  EXPECT_FALSE(ego_velocity_measurement(scan_, other, x_));
  other = set_;
  other.inliers = 3;
  EXPECT_FALSE(ego_velocity_measurement(scan_, other, x_));
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

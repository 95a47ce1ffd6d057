// SPDX-License-Identifier: BSD-3-Clause
// The mean of the state estimate: what happens to it on the way.
#include "rio/update/state_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rio/models/landmark_birth.hpp"
#include "rio/models/landmark_point.hpp"
#include "rio/update/gathered_covariance.hpp"
#include "rio/update/look_correlation.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

class StateEstimateTest : public testing::Test {
 protected:
  StateEstimateTest() {
    test::Random random(5);
    nav_ = random.state();
    nav_.time = Time(1'000'000'000);
    options_.imu.measure_noise = false;
    options_.frontend.matching = Matching::kEuclidean;
  }
  StateEstimate state_estimate(double velocity_sigma = 0.1) const {
    StateEstimate b(options_, 3);
    BodyCovariance P = 1e-6 * BodyCovariance::Identity();
    P.block<3, 3>(body::kVelocity, body::kVelocity) *= 1e6 * velocity_sigma * velocity_sigma;
    b.reset(nav_, P);
    return b;
  }
  /// A second of flight.
  void fly(StateEstimate* b, const Vector3d& a_W, const Vector3d& w_B) const {
    const ImuBuffer imu = samples(a_W, w_B);
    bool gap = true;
    ASSERT_EQ(b->propagate(imu.newest().time, imu, &gap), Status::kOk);
    EXPECT_FALSE(gap);
  }
  void add_landmark(const Vector3d& point_S, StateEstimate* b) const {
    b->add_landmark(make_detection({.point_S = point_S}, options_.radar));
  }
  /// Samples at 200 Hz for a second of a body that accelerates by a_W and turns by w_B.
  ImuBuffer samples(const Vector3d& a_W, const Vector3d& w_B) const {
    ImuBuffer imu(options_.timing, options_.imu);
    Quaternion q = nav_.q_WB;
    for (int i = 0; i <= 200; ++i) {
      const Vector3d force_W = a_W + Vector3d(0.0, 0.0, options_.imu.gravity);
      imu.push_back({nav_.time + Time(5'000'000 * i), w_B + nav_.gyro_bias,
                     q.conjugate() * force_W + nav_.accel_bias});
      q = q * test::rotation_of(0.005 * w_B);
    }
    return imu;
  }

  Options options_;
  NavState nav_;
};

TEST_F(StateEstimateTest, PropagationKeepsWayRateAndAcceleration) {
  nav_.v_WB.setZero();
  for (const double a : {0.07, 0.085, 1.0}) {
    StateEstimate b = state_estimate();
    const Vector3d w(0.1, 0.2, -0.3);
    fly(&b, {a, 0.0, 0.0}, w);
    EXPECT_NEAR(b.estimate().distance_travelled, 0.5 * a, 1e-3 * a);
    EXPECT_LT((b.estimate().gyro_B - w - nav_.gyro_bias).norm(), 1e-12);
    // five sigmas of white noise behind two low-passes: 5 sqrt(3) 4e-3 / sqrt(4 0.05) = 0.0775
    const double noise = 25.0 * 3.0 * 4e-3 * 4e-3 / (4.0 * 0.05);
    const double expected = a * a > noise ? a - noise / a : 0.0;
    EXPECT_NEAR(b.estimate().steady.accel_W.x(), expected, 1e-4) << a;
    EXPECT_EQ(expected > 0.0, a > 0.08);
  }
}

// What matching is told of a landmark is the covariance of the model's own rows.
TEST_F(StateEstimateTest, LandmarksArePredictedInTheRadarsAxes) {
  options_.frontend.matching = Matching::kMahalanobis;
  for (const CalibrationOptions& calibration : {CalibrationOptions{0.05, 0.03, 0.02, 0.02, 0.0},
                                                CalibrationOptions{0.0, 0.0, 0.02, 0.0, 0.0, 0.0},
                                                CalibrationOptions{0.05, 0.03, 0.0, 0.0, 0.0}}) {
    options_.calibration = calibration;
    options_.radar.T_BS.translation = Vector3d(0.1, -0.2, 0.05);
    StateEstimate b = state_estimate(0.5);
    for (const double y : {-2.0, 0.0, 3.0}) add_landmark({4.0, y, 1.0}, &b);
    fly(&b, {1.0, -2.0, 0.5}, {0.4, -0.2, 0.7});
    const LinearizationPoint x(b.estimate());
    for (int i = 0; i < 3; ++i) {
      const LandmarkState& landmark = b.estimate().landmarks[static_cast<std::size_t>(i)];
      const ObservedPoint point(x.T_WB, x.T_BS, landmark.p_W);
      // a look there, whose elevation has the common error
      const Detection d = make_detection({.point_S = point.e_S}, options_.radar);
      JacobianOf<3, LandmarkPointModel::Blocks::kDof> d_look;
      d_look << point.d_e, d.range * d.sigma_elevation_S.normalized();
      const auto rows = state_rows<3>(d_look, LandmarkPointModel::Blocks{}, x, {0, i}, b.layout());
      GatheredCovariance gathered;
      gathered.begin(b.covariance());
      const Matrix3d expected = gathered.product(rows);
      EXPECT_LT((landmark.covariance_S - expected).norm(), 1e-12 * expected.norm()) << i;
    }
  }
}

// A landmark has the common error of elevations from the detection it is born from; what becomes
// known of that error is taken back, what it has in common with the landmark remains.
TEST_F(StateEstimateTest, WhatIsConsideredIsNeverKnown) {
  StateEstimate b = state_estimate();
  add_landmark({4.0, 0.0, 0.0}, &b);
  const int at = b.layout().elevation_error();
  const int up = b.layout().landmark(0);
  const Quaternion q_WS = nav_.q_WB * options_.radar.T_BS.rotation;
  const double prior = options_.calibration.elevation_sigma * options_.calibration.elevation_sigma;
  EXPECT_NEAR(b.covariance().matrix()(at, at), prior, 1e-15);
  const Vector3d shared = b.covariance().matrix().block<3, 1>(up, at);  // -|m| t_el
  EXPECT_LT((shared - q_WS * Vector3d(0.0, 0.0, -4.0 * prior)).norm(), 1e-12);
  Eigen::VectorXd dx = Eigen::VectorXd::Zero(b.layout().capacity());
  dx[at] = 0.01;
  b.correct(dx);
  EXPECT_EQ(b.estimate().elevation_error, 0.01);
  b.covariance().matrix()(at, at) = 0.1 * prior;
  Eigen::MatrixXd expected = b.covariance().matrix();
  expected(at, at) = prior;
  b.consider();
  EXPECT_EQ(b.estimate().elevation_error, 0.0);
  EXPECT_EQ(Eigen::MatrixXd(b.covariance().matrix()), expected);
}

TEST_F(StateEstimateTest, LandmarksWalkWithTheWayAndWithErrorsThatLast) {
  for (const double elevation_walk : {0.0, 1e-4}) {
    StateEstimate b = state_estimate();
    add_landmark({4.0, 1.0, 1.0}, &b);
    LandmarkState& landmark = b.estimate().landmarks[0];
    landmark.looks.elevation_walk = elevation_walk;
    const int at = b.layout().landmark(0);
    const Vector3d before = b.covariance().matrix().diagonal().segment<3>(at);
    fly(&b, Vector3d::Zero(), Vector3d::Zero());
    const Vector3d added = b.covariance().matrix().diagonal().segment<3>(at) - before;
    const Vector3d expected = landmark_walk(landmark, b.estimate().nav.p_WB,
                                            options_.update.landmark_walk, nav_.v_WB.norm());
    EXPECT_LT((added - expected).norm(), 1e-9);
    EXPECT_EQ(added.z() > 2.0 * added.x(), elevation_walk > 0.0);
    EXPECT_EQ(landmark.distance_born, 0.0);
  }
}

TEST_F(StateEstimateTest, NothingChangesIfTheResultIsNotFinite) {
  nav_.p_WB.setConstant(1.797e308);
  nav_.v_WB.setConstant(1.7e308);
  StateEstimate b = state_estimate();
  const ImuBuffer imu = samples(Vector3d::Zero(), Vector3d::Zero());
  bool gap = false;
  EXPECT_EQ(b.propagate(imu.newest().time, imu, &gap), Status::kNumerical);
  EXPECT_EQ(b.estimate().nav.time, nav_.time);
  EXPECT_EQ(b.estimate().distance_travelled, 0.0);
}

// The noise of the gyro sample moves the radar by its lever arm.
TEST_F(StateEstimateTest, TheVarianceOfADopplerIncludesTheGyroSample) {
  constexpr double kSigma = 0.03;
  options_.calibration = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  options_.radar.T_BS = {test::rotation_of({0.3, 0.1, -0.4}), Vector3d(0.4, -0.3, 0.2)};
  StateEstimate b(options_, 3);
  b.reset(nav_, BodyCovariance::Zero());
  b.estimate().gyro_variance = kSigma * kSigma;
  LinearizationPoint x(b.estimate());
  const Vector3d mean = x.radar_velocity_S();
  Matrix3d expected = Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    x.gyro_B = kSigma * Vector3d::Unit(i);
    const Vector3d moved = x.radar_velocity_S() - mean;
    expected += moved * moved.transpose();
  }
  EXPECT_GT(expected.trace(), 1e-4);
  EXPECT_LT((b.radar_velocity_covariance() - expected).norm(), 1e-12);
  EXPECT_TRUE(b.velocity_calibration().isZero(0.0));
}

// That of a sample: density over interval. Not modelled where the noise is not measured.
TEST_F(StateEstimateTest, PropagationTellsTheNoiseOfTheGyroSample) {
  for (const bool measured : {true, false}) {
    options_.imu.measure_noise = measured;
    StateEstimate b = state_estimate();
    fly(&b, Vector3d::Zero(), Vector3d::Zero());
    const double density = options_.imu.gyro_noise_density;
    const double expected = measured ? density * density / 0.005 : 0.0;
    EXPECT_NEAR(b.estimate().gyro_variance, expected, 1e-3 * expected);
  }
}

// At a constant velocity the steady motion is that of the body, also after a restart.
TEST_F(StateEstimateTest, TheSteadyMotionStartsAtTheVelocity) {
  options_.imu.accel_noise_density = 1e-3;  // sees that the velocity does not turn with the body
  StateEstimate b = state_estimate();
  const auto expect_steady = [&b](const Vector3d& v_B) {
    EXPECT_LT((b.estimate().steady.v_B - v_B).norm(), 1e-3);
  };
  expect_steady(nav_.q_WB.conjugate() * nav_.v_WB);
  fly(&b, Vector3d::Zero(), {0.4, -0.2, 0.7});
  expect_steady(b.estimate().nav.q_WB.conjugate() * nav_.v_WB);
  b.restart_steady_motion({1.0, 2.0, 3.0});
  expect_steady({1.0, 2.0, 3.0});
}

TEST_F(StateEstimateTest, TheOldestCloneGivesWay) {
  StateEstimate b = state_estimate();
  for (ScanId scan = 0; scan < 5; ++scan) {
    b.estimate().nav.p_WB.x() = static_cast<double>(scan);
    b.clone(scan);
  }
  EXPECT_EQ(b.estimate().clones.size(), 3U);
  EXPECT_LT(b.estimate().find_clone(1), 0);
  for (ScanId scan = 2; scan < 5; ++scan) {
    const int slot = b.estimate().find_clone(scan);
    ASSERT_GE(slot, 0);
    EXPECT_EQ(b.estimate().clones[static_cast<std::size_t>(slot)].T_WB.p.x(),
              static_cast<double>(scan));
  }
}

// A slow radar beside a fast one still finds its last scan.
TEST_F(StateEstimateTest, ClonesAreThoseOfEachRadar) {
  ASSERT_TRUE(options_.other_radars.push_back({options_.radar.T_BS, 0.0, 0.0, {}}));
  StateEstimate b(options_, 0);
  b.reset(nav_, BodyCovariance::Identity());
  const auto kept = [&b](ScanId scan) { return b.estimate().find_clone(scan) >= 0; };
  b.select_radar(1);
  b.clone(0);
  b.select_radar(0);
  for (ScanId scan = 1; scan < 9; ++scan) b.clone(scan);
  EXPECT_TRUE(kept(0));
  EXPECT_FALSE(kept(5));
  EXPECT_EQ(b.estimate().clones.size(), 4U);
  b.select_radar(1);
  b.clone(8);  // at the same instant: they share the pose
  EXPECT_EQ(b.estimate().clones.size(), 4U);
  for (ScanId scan = 9; scan < 12; ++scan) b.clone(scan);
  EXPECT_FALSE(kept(0));
  for (const ScanId scan : {6U, 7U, 8U, 9U, 10U, 11U}) EXPECT_TRUE(kept(scan)) << scan;
  EXPECT_EQ(b.estimate().clones.size(), 6U);
}

TEST_F(StateEstimateTest, CorrectionsReachEveryBlock) {
  StateEstimate b = state_estimate();
  b.clone(0);
  add_landmark({4.0, 1.0, 1.0}, &b);
  const Estimate before = b.estimate();
  Eigen::VectorXd dx(b.layout().capacity());
  for (int i = 0; i < dx.size(); ++i) dx[i] = 0.02 * (1.0 + i);
  b.correct(dx);
  const Estimate& x = b.estimate();
  EXPECT_LT((test::error_of(x.nav, before.nav) - dx.head<15>()).norm(), 1e-13);
  const int clone = b.layout().clone(0);
  const Vector3d shift = dx.segment<3>(clone + 3);
  EXPECT_LT((x.clones[0].T_WB.p - before.clones[0].T_WB.p - shift).norm(), 1e-12);
  const Matrix3d turn = test::rotation_of(dx.segment<3>(clone)).toRotationMatrix();
  EXPECT_LT((x.clones[0].T_WB.R - before.clones[0].T_WB.R * turn).norm(), 1e-9);
  EXPECT_LT(
      (x.landmarks[0].p_W - before.landmarks[0].p_W - dx.segment<3>(b.layout().landmark(0))).norm(),
      1e-12);
}

}  // namespace
}  // namespace rio

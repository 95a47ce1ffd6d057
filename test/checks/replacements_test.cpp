// SPDX-License-Identifier: BSD-3-Clause
// What happens to mean and covariance when velocity, gravity or a bias turn out to be wrong.
#include "rio/checks/replacements.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random_state.hpp"

namespace rio {
namespace {

class ReplacementsTest : public testing::Test {
 protected:
  ReplacementsTest() {
    test::Random random(5);
    nav_ = random.state();
    nav_.time = Time(1'000'000'000);
  }
  StateEstimate state_estimate(double velocity_sigma = 0.1) const {
    StateEstimate b(options_, 3);
    BodyCovariance P = 1e-6 * BodyCovariance::Identity();
    P.block<3, 3>(body::kVelocity, body::kVelocity) *= 1e6 * velocity_sigma * velocity_sigma;
    b.reset(nav_, P);
    return b;
  }

  /// The change adds this to the covariance of the body, and nothing else. Returns the state after.
  template <class Change>
  NavState expect_added(const Matrix15d& expected, const Change& change) const {
    StateEstimate b = state_estimate();
    const Matrix15d before = b.covariance().body();
    change(&b);
    const Matrix15d off = b.covariance().body() - before - expected;
    EXPECT_LT((off.array() / (1.0 + expected.array())).matrix().norm(), 1e-12);
    return b.estimate().nav;
  }

  Options options_;
  NavState nav_;
};

// The velocity becomes the measured one, and the position what it would be, had it been that for
// the duration.
TEST_F(ReplacementsTest, VelocityTakesThePositionAlong) {
  for (const double duration : {0.0, 0.8}) {
    StateEstimate b = state_estimate(0.01);
    const Vector3d v_B(1.0, -2.0, 0.5);
    const Matrix3d noise = 1e-4 * Matrix3d::Identity();
    const Vector3d error = nav_.q_WB * v_B - nav_.v_WB;
    replace_velocity({v_B, noise}, duration, 0.0, &b);
    EXPECT_LT((b.estimate().nav.v_WB - nav_.q_WB * v_B).norm(), 1e-3);
    EXPECT_LT((b.estimate().nav.p_WB - nav_.p_WB - duration * error).norm(), 1e-3);
    const auto P = b.covariance().matrix();
    EXPECT_NEAR(P(body::kVelocity, body::kVelocity), 1e-4, 1e-6);
    // what the velocity before did not know and what the measured one does not
    EXPECT_NEAR(P(body::kPosition, body::kPosition), 1e-6 + duration * duration * 2e-4, 1e-6);
  }
}

// The position may be off by what the difference has done since it may have been wrong.
TEST_F(ReplacementsTest, VelocityLeavesThePositionInDoubt) {
  StateEstimate b = state_estimate(0.01);
  const Vector3d v_B = nav_.q_WB.conjugate() * nav_.v_WB + Vector3d(0.0, 0.3, 0.4);
  replace_velocity({v_B, 1e-4 * Matrix3d::Identity()}, 0.0, 6.0, &b);
  EXPECT_LT((b.estimate().nav.p_WB - nav_.p_WB).norm(), 1e-9);
  EXPECT_NEAR(b.covariance().matrix()(body::kPosition, body::kPosition), 9.0, 1e-3);
}

// Measured noise in body axes counts in world axes.
TEST_F(ReplacementsTest, VelocityHasTheNoiseOfItsAxes) {
  StateEstimate b = state_estimate();
  const Matrix3d noise = Vector3d(0.01, 0.04, 0.09).asDiagonal();
  replace_velocity({Vector3d(40.0, 10.0, 20.0), noise}, 0.1, 0.0, &b);
  const Matrix3d R = nav_.q_WB.toRotationMatrix();
  const Matrix3d P = b.covariance().matrix().block<3, 3>(body::kVelocity, body::kVelocity);
  EXPECT_LT((R.transpose() * P * R - noise).norm(), 1e-4);
}

TEST_F(ReplacementsTest, TiltHasGravityWhereItWasMeasured) {
  constexpr double kSigma = 0.05;
  constexpr double kDuration = 3.0;
  const Vector3d g_B = test::rotation_of({0.2, -0.1, 0.3}) *
                       (nav_.q_WB.conjugate() * Vector3d(0.0, 0.0, -options_.imu.gravity));
  const Vector3d v_B = nav_.q_WB.conjugate() * nav_.v_WB;
  const double off = (nav_.q_WB * g_B + options_.imu.gravity * Vector3d::UnitZ()).norm();
  const double angle = kSigma / options_.imu.gravity;
  const double speed = 0.5 + v_B.norm() * off / options_.imu.gravity;
  const double distance = 0.5 * off * kDuration * kDuration + speed * (kDuration + 4.0);
  const double rate = angle / (kDuration + 4.0);
  const double bias = options_.start.sigma_accel_bias;
  Matrix15d expected = Matrix15d::Zero();
  expected.diagonal().segment<3>(body::kAttitude).setConstant(angle * angle);
  expected.diagonal().segment<3>(body::kPosition).setConstant(distance * distance);
  expected.diagonal().segment<3>(body::kGyroBias).setConstant(rate * rate);
  expected.diagonal().segment<3>(body::kAccelBias).setConstant(bias * bias);
  const IndependentVelocity velocity{v_B + Vector3d(0.3, 0.0, 0.4), Matrix3d::Zero()};
  const NavState x = expect_added(expected, [&](StateEstimate* b) {
    replace_tilt({g_B, kSigma, velocity}, kDuration, options_, b);
  });
  EXPECT_LT((x.q_WB * g_B + options_.imu.gravity * Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_LT((x.q_WB.conjugate() * x.v_WB - v_B).norm(), 1e-12);
  EXPECT_EQ(x.p_WB, nav_.p_WB);
}

// Of an alignment in motion nothing is left but what every start knows.
TEST_F(ReplacementsTest, WithdrawnAlignmentKnowsNoBias) {
  constexpr double kSpeed = 1.2;
  const double tilt = kSpeed / options_.start.duration / options_.imu.gravity;
  const double bias = options_.start.sigma_gyro_bias;
  Matrix15d expected = Matrix15d::Zero();
  expected.diagonal().segment<3>(body::kAttitude).setConstant(tilt * tilt);
  expected.diagonal().segment<3>(body::kGyroBias).setConstant(bias * bias);
  const NavState x =
      expect_added(expected, [&](StateEstimate* b) { withdraw_alignment(kSpeed, options_, b); });
  EXPECT_EQ(x.gyro_bias, Vector3d::Zero());
}

TEST_F(ReplacementsTest, WidenedHeadingKeepsTheTilt) {
  const LastingError step{.error = -0.004, .duration = 20.0, .moved_W = {3.0, 4.0, 0.0}};
  const Vector3d up_B = nav_.q_WB.conjugate() * Vector3d::UnitZ();
  Matrix15d expected = Matrix15d::Zero();
  expected.block<3, 3>(body::kGyroBias, body::kGyroBias) = 0.008 * 0.008 * up_B * up_B.transpose();
  expected.block<3, 3>(body::kAttitude, body::kAttitude) = 0.16 * 0.16 * up_B * up_B.transpose();
  expected.diagonal().segment<3>(body::kVelocity).setConstant(0.0256 * nav_.v_WB.squaredNorm());
  expected.diagonal().segment<3>(body::kPosition).setConstant(0.4 * 0.4);
  const NavState x = expect_added(expected, [&](StateEstimate* b) { widen_heading(step, b); });
  EXPECT_EQ(x.q_WB.coeffs(), nav_.q_WB.coeffs());
}

// By what they may be, or by the error seen if that is more; the mean stays.
TEST_F(ReplacementsTest, WidenedBiasesMayHaveActedForTheWindow) {
  const double accel = options_.start.sigma_accel_bias;
  const double gyro = options_.start.sigma_gyro_bias;
  for (const double error : {-0.01, -0.4}) {
    const double speed = std::max(3.0 * accel, std::abs(error));
    Matrix15d expected = Matrix15d::Zero();
    expected.diagonal().segment<3>(body::kPosition).setConstant(2.25 * speed * speed);
    expected.diagonal().segment<3>(body::kVelocity).setConstant(speed * speed);
    expected.diagonal().segment<3>(body::kAccelBias).setConstant(accel * accel);
    expected.diagonal().segment<3>(body::kGyroBias).setConstant(gyro * gyro);
    expected.diagonal().segment<3>(body::kAttitude).setConstant(36.0 * gyro * gyro);
    const NavState x = expect_added(expected, [&](StateEstimate* b) {
      widen_biases({.error = error, .duration = 3.0}, options_, b);
    });
    EXPECT_EQ(x.v_WB, nav_.v_WB);
  }
}

TEST_F(ReplacementsTest, WidenedPositionIsThatMuchLessCertain) {
  Matrix15d expected = Matrix15d::Zero();
  expected.diagonal().segment<3>(body::kPosition).setConstant(0.49);
  const NavState x = expect_added(expected, [](StateEstimate* b) { widen_position(0.7, b); });
  EXPECT_EQ(x.p_WB, nav_.p_WB);
}

// A step of the clock is known to the jitter of arrivals, for each radar its own; without a state
// of the time offset there is nothing to widen.
TEST_F(ReplacementsTest, AClockThatSteppedIsOffByAnArrival) {
  options_.other_radars.push_back({options_.radar.T_BS, 0.0, 0.0, {}});
  for (const double sigma : {0.03, 0.0}) {
    options_.calibration.time_offset_sigma = sigma;
    StateEstimate b = state_estimate();
    const Eigen::MatrixXd before = b.covariance().matrix();
    widen_time_offset(1, &b);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(before.rows(), before.cols());
    const int column = b.layout().of_radar(1).time_offset_column();
    ASSERT_EQ(column >= 0, sigma > 0.0);
    if (column >= 0) expected(column, column) = 0.02 * 0.02;
    EXPECT_LT((b.covariance().matrix() - before - expected).cwiseAbs().maxCoeff(), 1e-12) << sigma;
  }
}

}  // namespace
}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The sliding-window smoother without a front-end: failures, new windows in the middle of things,
// dead reckoning.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rio/checks/replacements.hpp"
#include "rio/core/so3.hpp"
#include "rio/smoother/smoother.hpp"
#include "support/scanwise_flight.hpp"

namespace rio::test {
namespace {

/// All that a smoother shows, number by number.
std::vector<double> numbers_of(const Smoother& smoother) {
  std::vector<double> all;
  const auto add = [&all](const auto& m) { all.insert(all.end(), m.data(), m.data() + m.size()); };
  const auto add_state = [&](const NavState& x) {
    all.push_back(to_seconds(x.time));
    add(x.q_WB.coeffs());
    for (const Vector3d& v : {x.p_WB, x.v_WB, x.gyro_bias, x.accel_bias}) add(v);
  };
  for (std::size_t k = 0; k < smoother.window().size(); ++k) {
    const WindowState& state = smoother.window()[k];
    add_state(state.nav);
    for (const std::size_t count : state.measurements.sizes()) {
      all.push_back(static_cast<double>(count));
    }
    all.push_back(state.to_next.valid() ? 1.0 : 0.0);
  }
  const Estimate& x = smoother.estimate();
  add_state(x.nav);
  add(x.T_BS.rotation.coeffs());
  add(x.T_BS.translation);
  all.push_back(x.time_offset);
  for (const LandmarkState& landmark : x.landmarks) add(landmark.p_W);
  add(Eigen::MatrixXd(smoother.state_estimate().covariance().matrix()));
  add(Eigen::MatrixXd(smoother.prior().A()));
  return all;
}

/// A smoother without a front-end, which sees nothing but the points it is given as landmarks.
class BlindSmootherTest : public ScanwiseTest<SmootherFlight> {
 protected:
  BlindSmootherTest()
      : ScanwiseTest(ideal_flight(1.5)), smoother_(flight_.options()), rows_(flight_.options()) {
    smoother_.reset(flight_.flight().truth.front(), flight_.start_covariance());
    nothing_.scan = &scan_;
    nothing_.trails = &trails_;
  }

  void step(int scans = 1) {
    for (int i = 0; i < scans; ++i) {
      ASSERT_EQ(predict(), Status::kOk);
      ASSERT_EQ(update(), Status::kOk);
    }
  }
  Status update() {
    rows_.build(nothing_, smoother_.state_estimate(), &report_);
    return smoother_.update(nothing_, rows_);
  }
  Status predict() {
    bool gap = false;
    return smoother_.propagate(flight_.flight().scans[next_++].time, flight_.imu(), &gap);
  }
  /// @param sigma of the range [m]
  void give_birth(double sigma) {
    Promotions promotions;
    promotions.births.push_back(
        make_detection({.point_S = {4.0, 1.0, 0.0}}, flight_.options().radar));
    promotions.births[0].sigma_range = sigma;
    smoother_.maintain_landmarks(nothing_, rows_, promotions, &report_);
  }

  Smoother smoother_;
  ScanRows rows_;
  DetectionList scan_;
  TrailSet trails_{1, 1};
  Observations nothing_;
  UpdateReport report_;
  std::size_t next_ = 0;
};

TEST_F(BlindSmootherTest, AFailedUpdateLeavesThePrediction) {
  step(15);
  give_birth(0.03);
  step();
  give_birth(0.0);  // infinite information: no solution exists any more
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(predict(), Status::kOk);
    const std::vector<double> predicted = numbers_of(smoother_);
    EXPECT_EQ(update(), Status::kNumerical);
    EXPECT_EQ(numbers_of(smoother_), predicted);  // to the last bit
  }
  // once the landmark is gone all goes on, with the IMU since the last solution
  smoother_.drop_landmarks(&report_);
  const Vector3d before = smoother_.estimate().nav.p_WB;
  EXPECT_EQ(update(), Status::kOk);
  EXPECT_EQ(smoother_.window().newest().nav.time, smoother_.estimate().nav.time);
  // nothing was measured: the solution is the prediction, but for the round-off of the system
  EXPECT_LT((smoother_.estimate().nav.p_WB - before).norm(), 1e-6);
}

TEST_F(BlindSmootherTest, AnotherVelocityBeginsANewWindow) {
  step(15);
  give_birth(0.03);
  const Estimate before = smoother_.estimate();
  ASSERT_EQ(before.landmarks.size(), 1U);
  constexpr double kSigma = 0.1;
  constexpr double kDuration = 0.5;
  const Vector3d error(1.0, -0.7, 0.4);
  const Matrix3d R_then = before.nav.q_WB.toRotationMatrix();
  const Vector3d v_B = R_then.transpose() * (before.nav.v_WB + error);
  const IndependentVelocity found{v_B, kSigma * kSigma * Matrix3d::Identity()};
  smoother_.replace([&](StateEstimate* x) { replace_velocity(found, kDuration, 0.0, x); },
                    Invalidates::kLandmarks, &report_);
  EXPECT_EQ(smoother_.window().size(), 1U);
  EXPECT_EQ(smoother_.estimate().landmarks.size(), 0U);
  EXPECT_EQ(report_.landmarks_removed, 1);
  const Eigen::MatrixXd P = smoother_.state_estimate().covariance().matrix();
  const NavState& nav = smoother_.estimate().nav;
  // the velocity is the new one, the position has followed it, and their sigmas know it
  EXPECT_LT((nav.v_WB - before.nav.v_WB - error).norm(), 0.02);
  EXPECT_LT((nav.p_WB - before.nav.p_WB - kDuration * error).norm(), 0.02);
  for (int v = body::kVelocity; v < body::kVelocity + 3; ++v) {
    EXPECT_LT(P(v, v), 1.01 * kSigma * kSigma);
    EXPECT_GT(P(v, v), 0.9 * kSigma * kSigma);
  }
  // the prior of the new window knows what the covariance does, in the axes of prior.hpp (E4)
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(P.rows(), P.cols());
  Eigen::MatrixXd M = I;
  const Matrix3d R = nav.q_WB.toRotationMatrix();
  M.topLeftCorner<3, 3>() = R;
  const Matrix3d heading = Vector3d::UnitZ() * R.row(2);
  M.block<3, 3>(body::kPosition, 0) = skew(nav.p_WB) * heading;
  M.block<3, 3>(body::kVelocity, 0) = skew(nav.v_WB) * heading;
  const Eigen::MatrixXd product = smoother_.prior().A() * M * P * M.transpose();
  // it adds 1e-5 squared to every variance; the least one is that of the gyroscope's bias
  const double least = P.diagonal().minCoeff();
  EXPECT_LE((product - I).diagonal().cwiseAbs().maxCoeff(), 10.0 * 1e-10 / least);
}

TEST_F(BlindSmootherTest, AReopenedPositionBeginsANewWindow) {
  step(15);
  give_birth(0.03);
  const Eigen::Index position = body::kPosition;
  const Eigen::MatrixXd before = smoother_.state_estimate().covariance().matrix();
  smoother_.replace([](StateEstimate* x) { widen_position(0.5, x); }, Invalidates::kLandmarks,
                    &report_);
  EXPECT_EQ(smoother_.window().size(), 1U);
  EXPECT_EQ(report_.landmarks_removed, 1);
  step();  // the next solution knows it, too
  const Eigen::MatrixXd P = smoother_.state_estimate().covariance().matrix();
  for (Eigen::Index i = position; i < position + 3; ++i) {
    EXPECT_NEAR(P(i, i) - before(i, i), 0.25, 0.01);
  }
}

TEST_F(BlindSmootherTest, WithoutMeasurementsItIsDeadReckoning) {
  StateEstimate state_estimate(flight_.options(), 0);
  state_estimate.reset(flight_.flight().truth.front(), flight_.start_covariance());
  for (std::size_t i = 0; i < 40; ++i) {
    step();
    bool gap = false;
    ASSERT_EQ(state_estimate.propagate(flight_.flight().scans[i].time, flight_.imu(), &gap),
              Status::kOk);
  }
  // means: as good as the information matrices, whose condition is some 1e10, let it be
  EXPECT_LT((smoother_.estimate().nav.p_WB - state_estimate.estimate().nav.p_WB).norm(), 1e-6);
  EXPECT_LT((smoother_.estimate().nav.v_WB - state_estimate.estimate().nav.v_WB).norm(), 1e-6);
  // covariance: the start adds 1e-5 squared to each variance
  const BodyCovariance expected = state_estimate.covariance().body();
  const BodyCovariance P = smoother_.state_estimate().covariance().body();
  for (int i = 0; i < body::kSize; ++i) EXPECT_NEAR(P(i, i), expected(i, i), 1e-4 * expected(i, i));
}

}  // namespace
}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rio/core/so3.hpp"
#include "rio/sim/imu.hpp"

namespace rio::sim {
namespace {

constexpr std::uint64_t kSeeds[] = {1, 2, 3, 7, 42, 1001};

TEST(Trajectory, DerivativesAgreeWithDifferences) {
  const Trajectory trajectory = indoor_flight(3, 150.0);
  constexpr double kStep = 1e-4;
  double largest_rate = 0.0;
  for (double t = 3.9; t < trajectory.duration() - 1.9; t += 0.0371) {
    const Trajectory::Point before = trajectory.at(t - kStep);
    const Trajectory::Point point = trajectory.at(t);
    const Trajectory::Point after = trajectory.at(t + kStep);
    const Vector3d v = (after.nav.p_WB - before.nav.p_WB) / (2.0 * kStep);
    const Vector3d a = (after.nav.v_WB - before.nav.v_WB) / (2.0 * kStep);
    const Quaternion turn(before.nav.q_WB.conjugate() * after.nav.q_WB);
    const Vector3d w = quaternion_log(turn) / (2.0 * kStep);
    const Vector3d f_B = point.nav.q_WB.conjugate() * (a + 9.81 * Vector3d::UnitZ());
    // truncation kStep^2/6 times the third derivative (< 100) is 2e-7; rounding 1e-11
    ASSERT_LT((v - point.nav.v_WB).norm(), 1e-6) << t;
    ASSERT_LT((a - point.accel_W).norm(), 1e-6) << t;
    ASSERT_LT((f_B - point.accel_B).norm(), 1e-6) << t;
    ASSERT_LT((w - point.gyro_B).norm(), 1e-6) << t;
    largest_rate = std::max(largest_rate, point.gyro_B.cwiseAbs().minCoeff());
  }
  EXPECT_GT(largest_rate, 0.2);  // all three axes were exercised at once
}

TEST(Trajectory, IntegratedImuReturnsToTheTruth) {
  const Trajectory trajectory = indoor_flight(5, 150.0);
  constexpr double kRate = 2000.0;
  constexpr double kBegin = 4.0;
  const Vector3d gravity(0.0, 0.0, -9.81);
  NavState nav = trajectory.at(kBegin).nav;
  ImuModel model = ImuModel::noise_free();
  model.rate_hz = kRate;
  ImuSimulator imu(model, 5);
  for (int i = 0; i < static_cast<int>(30.0 * kRate); ++i) {
    const ImuSample sample = imu.sample(trajectory.at(kBegin + (i + 0.5) / kRate));
    // midpoint rule: attitude at half the step turns the specific force
    const Vector3d half_turn = 0.5 / kRate * sample.gyro_B;
    const Quaternion middle(nav.q_WB * quaternion_exp(half_turn));
    const Vector3d a = middle * sample.accel_B + gravity;
    nav.p_WB += nav.v_WB / kRate + 0.5 / (kRate * kRate) * a;
    nav.v_WB += a / kRate;
    nav.q_WB = (middle * quaternion_exp(half_turn)).normalized();
  }
  const NavState truth = trajectory.at(kBegin + 30.0).nav;
  EXPECT_GT((truth.p_WB - trajectory.at(kBegin).nav.p_WB).norm(), 0.5);
  EXPECT_LT((nav.p_WB - truth.p_WB).norm(), 1e-3);  // the midpoint rule's own error is below 0.1 mm
  EXPECT_LT((nav.v_WB - truth.v_WB).norm(), 1e-4);
  EXPECT_LT(nav.q_WB.angularDistance(truth.q_WB), 1e-6);
}

TEST(Trajectory, TimeAndSecondsAreTheSameInstant) {
  const Time start(1'700'000'000'000'000'000);
  const Trajectory trajectory = indoor_flight(1, 30.0, start);
  const Trajectory::Point a = trajectory.at(start + Time(7'123'456'789));
  const Trajectory::Point b = trajectory.at(7.123456789);
  EXPECT_EQ(a.nav.time, start + Time(7'123'456'789));
  EXPECT_EQ(b.nav.time, a.nav.time);
  EXPECT_LT((a.nav.p_WB - b.nav.p_WB).norm(), 1e-12);
  EXPECT_GT(a.nav.p_WB.norm(), 0.1);
}

TEST(Trajectory, DefaultStandsAtTheOrigin) {
  const Trajectory::Point point = Trajectory().at(1.0);
  EXPECT_EQ(point.nav.p_WB, Vector3d::Zero());
  EXPECT_EQ(point.accel_B, Vector3d(0.0, 0.0, 9.81));
}

TEST(IndoorFlight, StandsExactlyStillAtBothEnds) {
  const Trajectory trajectory = indoor_flight(2, 140.0);
  const Trajectory::Point first = trajectory.at(0.0);
  EXPECT_TRUE(first.nav.q_WB.isApprox(Quaternion::Identity(), 0.0));
  EXPECT_EQ(first.nav.p_WB, Vector3d::Zero());
  const double end = trajectory.duration();
  for (const double t : {0.0, 1.7, 4.0, end - 2.0, end - 0.5, end, end + 10.0}) {
    const Trajectory::Point point = trajectory.at(t);
    EXPECT_EQ(point.nav.v_WB, Vector3d::Zero()) << t;
    EXPECT_EQ(point.accel_W, Vector3d::Zero()) << t;
    EXPECT_EQ(point.gyro_B, Vector3d::Zero()) << t;
    EXPECT_EQ(point.accel_B, Vector3d(0.0, 0.0, 9.81)) << t;
    EXPECT_FALSE(point.flying) << t;
  }
  EXPECT_TRUE(trajectory.at(5.0).flying);
  EXPECT_LT(trajectory.at(end).nav.p_WB.norm(), 1.2);        // lands near the start ...
  EXPECT_NEAR(trajectory.at(end).nav.p_WB.z(), 0.0, 1e-12);  // ... on the ground
}

TEST(IndoorFlight, KeepsItsEnvelopeForEverySeed) {
  for (const std::uint64_t seed : kSeeds) {
    const double wanted = 130.0 + static_cast<double>(seed % 46);
    const Trajectory trajectory = indoor_flight(seed, wanted);
    constexpr double kStep = 0.01;
    double length = 0.0;
    double peak = 0.0;
    double yaw_min = 0.0;
    double yaw_max = 0.0;
    double time_flying = 0.0;
    Vector3d low = Vector3d::Zero();
    Vector3d high = Vector3d::Zero();
    Vector3d speed_sum = Vector3d::Zero();
    for (double t = 0.0; t < trajectory.duration(); t += kStep) {
      const Trajectory::Point point = trajectory.at(t);
      const double speed = point.nav.v_WB.norm();
      length += speed * kStep;
      time_flying += point.flying ? kStep : 0.0;
      speed_sum += point.nav.v_WB.cwiseAbs() * kStep;
      peak = std::max(peak, speed);
      low = low.cwiseMin(point.nav.p_WB);
      high = high.cwiseMax(point.nav.p_WB);
      const Vector3d x_B = point.nav.q_WB * Vector3d::UnitX();
      const double yaw = std::atan2(x_B.y(), x_B.x());
      yaw_min = std::min(yaw_min, yaw);
      yaw_max = std::max(yaw_max, yaw);
    }
    SCOPED_TRACE(seed);
    EXPECT_NEAR(length, wanted, 0.001 * wanted);  // the rectangle rule is this good
    EXPECT_NEAR(trajectory.length(), wanted, 1e-6 * wanted);
    EXPECT_LT(peak, 1.45);
    EXPECT_GT(peak, 1.3);
    EXPECT_NEAR(length / time_flying, 0.7, 0.07);
    EXPECT_LT((high - low).x(), 6.0);
    EXPECT_LT((high - low).y(), 5.0);
    EXPECT_LT((high - low).z(), 1.7);
    EXPECT_GT((high - low).minCoeff(), 1.4);               // and uses it
    EXPECT_GT((speed_sum / time_flying).minCoeff(), 0.2);  // in all axes
    EXPECT_GE(low.z(), 0.0);
    EXPECT_GT(yaw_max, 1.4);
    EXPECT_LT(yaw_max, 1.8);
    EXPECT_LT(yaw_min, -1.4);
    EXPECT_GT(yaw_min, -1.8);
  }
}

}  // namespace
}  // namespace rio::sim

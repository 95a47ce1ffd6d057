// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rio/core/so3.hpp"
#include "rio/sim/path.hpp"
#include "sim/extent.hpp"
#include "support/imu_integration.hpp"

namespace rio::sim {
namespace {

TEST(Trajectory, DerivativesAgreeWithDifferences) {
  const Trajectory trajectory = random_flight(3, {.length = 150.0});
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
  const Trajectory trajectory = random_flight(5, {.length = 150.0});
  const test::Drift drift = test::integrate_imu(trajectory, 4.0, 30.0, 2000.0);
  EXPECT_GT(drift.moved, 15.0);
  // measured 2e-11 m and 1e-14 rad: what is left is rounding and the error of the method
  EXPECT_LT(drift.position, 1e-9);
  EXPECT_LT(drift.attitude, 1e-12);
}

TEST(Trajectory, LiesInTheBoxOfItsCorners) {
  const Trajectory trajectory = random_flight(5, {.length = 60.0});
  const Extent all = extent(trajectory);
  EXPECT_GE((all.low - trajectory.low()).minCoeff(), 0.0);
  EXPECT_GE((trajectory.high() - all.high).minCoeff(), 0.0);
  // control points lie beside the curve by no more than a step of 0.5 s at 1.43 m/s
  EXPECT_LT((all.low - trajectory.low()).maxCoeff(), 0.72);
  EXPECT_LT((trajectory.high() - all.high).maxCoeff(), 0.72);
}

TEST(Trajectory, TimeAndSecondsAreTheSameInstant) {
  const Time start(1'700'000'000'000'000'000);
  const Trajectory trajectory = random_flight(1, {.length = 30.0}, start);
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

}  // namespace
}  // namespace rio::sim

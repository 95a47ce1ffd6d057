// SPDX-License-Identifier: BSD-3-Clause
// The odometry API on a body that swings along x and sees a few points: which scans are late, what
// a buffer that is full costs, what is taken back.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "api/swinging_body.hpp"
#include "support/measured.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// Every scan is stamped late, which is found out scan by scan: one that follows at once was
// measured before the estimate as it is now dated, and is no late scan.
TEST_F(EngineTest, AScanThatOnlyABetterTimeOffsetHasOvertakenIsTaken) {
  auto odometry = started();
  bool overtaken = false;
  for (int i = 1; i < 30; ++i) {
    const Time t = kStart + milliseconds(50 * i);
    feed(*odometry, t + milliseconds(30));
    ASSERT_EQ(odometry->add_scan(scan(t, milliseconds(20))), Status::kOk);
    const Time before = odometry->at_scan().time;
    RadarScan twin = scan(t, milliseconds(20));
    twin.time += microseconds(1);
    twin.detections[0].range_rate += 1e-9;  // or it would be a repeated one
    EXPECT_EQ(odometry->add_scan(twin), Status::kOk) << i;
    overtaken = overtaken || odometry->at_scan().time == before;
    EXPECT_GE(odometry->at_scan().time, before);
  }
  EXPECT_TRUE(overtaken);
  EXPECT_EQ(odometry->counters().scans_late, 0U);
}

// A radar that has stopped working may send its last scan for ever.
TEST_F(EngineTest, AScanAgainIsADuplicateWhateverItsStamp) {
  auto odometry = started();
  feed(*odometry, kStart + milliseconds(400));
  RadarScan seen = scan(kStart + milliseconds(50));
  EXPECT_EQ(odometry->add_scan(seen), Status::kOk);
  for (int i = 2; i <= 3; ++i) {
    seen.time = kStart + milliseconds(50 * i);
    EXPECT_EQ(odometry->add_scan(seen), Status::kDuplicate);
  }
  EXPECT_EQ(odometry->counters().scans_duplicate, 2U);
  EXPECT_EQ(odometry->counters().scans, 1U);
  EXPECT_EQ(odometry->add_scan(scan(kStart + milliseconds(200))), Status::kOk);
  for (int i = 5; i <= 6; ++i) {  // all Dopplers in the cell of zero: it stands
    seen.time = kStart + milliseconds(50 * i);
    for (RadarDetection& d : seen.detections) d.range_rate = 0.0;
    EXPECT_EQ(odometry->add_scan(seen), Status::kOk);
  }
}

// But what the estimate has been carried past without a scan is.
TEST_F(EngineTest, AScanBehindTheLagIsLateAlsoIfItFollowsTheLastOne) {
  options_.timing.max_lag = 0.2;
  auto odometry = started();
  const Time t = kStart + milliseconds(100);
  feed(*odometry, t);
  ASSERT_EQ(odometry->add_scan(scan(t)), Status::kOk);
  feed(*odometry, t + milliseconds(500));
  EXPECT_EQ(odometry->add_scan(scan(t + milliseconds(250))), Status::kLate);
  EXPECT_EQ(odometry->counters().scans_late, 1U);
  EXPECT_EQ(odometry->add_scan(scan(t + milliseconds(350))), Status::kOk);
}

// The estimate follows the oldest sample kept: none is lost on the way.
TEST_F(EngineTest, AFullBufferIsCaughtUp) {
  auto patient = started();
  feed(*patient, kStart + milliseconds(900));
  EXPECT_EQ(patient->at_scan().time, kStart);
  options_.timing.imu_buffer = 32;
  next_ = kStart;
  auto hurried = started();
  for (int i = 1; i <= 180; ++i) {
    feed(*hurried, kStart + i * kSample);
    EXPECT_LE(hurried->now().time - hurried->at_scan().time, 32 * kSample);
  }
  EXPECT_LT((hurried->now().p_WB - patient->now().p_WB).norm(), 1e-9);
  EXPECT_LT((hurried->at_scan().p_WB - truth(hurried->at_scan().time).p_WB).norm(), 1e-3);
  EXPECT_GT((hurried->at_scan().p_WB - truth(kStart).p_WB).norm(), 0.1);
  // no sooner than needed
  EXPECT_GE(hurried->now().time - hurried->at_scan().time, 30 * kSample);
}

// A start that is wrong by two metres a second is found out, and what it has done to the position
// is taken back: the restart knows since when.
TEST_F(EngineTest, AWrongVelocityIsTakenBackFromThePosition) {
  options_.calibration = {0.0, 0.0, 0.0, 0.0, 0.0};  // it would take a part of the error
  auto odometry = started();
  NavState wrong = truth(kStart);
  wrong.v_WB.y() += 2.0;
  ASSERT_EQ(odometry->reset(wrong, 1e-6 * BodyCovariance::Identity()), Status::kOk);
  double farthest = 0.0;
  Time t = kStart;
  for (int i = 1; odometry->counters().velocity_resets == 0 && i < 60; ++i) {
    const double y = odometry->now().p_WB.y();
    farthest = std::max(farthest, y);
    t = kStart + milliseconds(50 * i);
    feed(*odometry, t);
    ASSERT_EQ(odometry->add_scan(scan(t)), Status::kOk);
  }
  EXPECT_EQ(odometry->counters().velocity_resets, 1U);
  measured("position before the restart [m]", farthest, "above 0.2");
  measured("position after it [m]", odometry->at_scan().p_WB.y(), "below a fifth");
  EXPECT_GT(farthest, 0.2);
  EXPECT_LT(std::abs(odometry->at_scan().p_WB.y()), 0.2 * farthest);
  EXPECT_LT((odometry->at_scan().v_WB - truth(t).v_WB).norm(), 0.1);
}

// A crowd that fills the view for a second and a half, too short for its velocity to be believed.
// That contradicts by 1.1 m/s, with the Dopplers of the last second for up to 2.5 s.
TEST_F(EngineTest, AfterACrowdThePositionIsReopenedOnce) {
  auto odometry = started();
  double reopened = 0.0;
  for (int i = 1; i <= 100; ++i) {
    const Time t = kStart + milliseconds(50 * i);
    RadarScan seen = scan(t);
    for (RadarDetection& d : seen.detections) {
      if (i > 40 && i <= 70) d.range_rate += d.point_S.normalized().dot(Vector3d(0.8, 0.8, 0.0));
    }
    feed(*odometry, t + kSample);
    ASSERT_EQ(odometry->add_scan(seen), Status::kOk) << i;
    if (i <= 70) {
      EXPECT_EQ(odometry->counters().position_reopened, 0U) << i;
    }
    reopened = std::max(reopened, odometry->report().position_reopened);
  }
  EXPECT_EQ(odometry->counters().position_reopened, 1U);
  EXPECT_EQ(odometry->counters().velocity_resets, 0U);
  EXPECT_GT(reopened, 1.1 * 1.5);
  EXPECT_LT(reopened, 1.1 * 2.5);
}

// Semi-definite: a hundred metres beside a millimetre.
TEST_F(EngineTest, AStartMayBeSureOfDifferencesAlone) {
  BodyCovariance P0 = 1e-6 * BodyCovariance::Identity();
  P0.block<3, 3>(body::kPosition, body::kPosition).setConstant(1e4);
  for (const BackEnd backend : {BackEnd::kEkf, BackEnd::kSmoother}) {
    options_.backend = backend;
    next_ = kStart;
    auto odometry = started();
    ASSERT_EQ(odometry->reset(truth(kStart), P0), Status::kOk);
    fly(*odometry, milliseconds(1000));
    EXPECT_EQ(odometry->counters().updates_failed, 0U);
    EXPECT_LT((odometry->at_scan().v_WB - truth(odometry->at_scan().time).v_WB).norm(), 0.05);
  }
}

// A body that glides at 1 m/s and turns at 0.02 rad/s, which no IMU tells from standing on a tilt
// with a bias. The Dopplers contradict the standstill at once: the rate was no bias.
TEST(GlidingTest, AnAlignmentInMotionTeachesNoBias) {
  constexpr double kSpeed = 1.0;  // [m/s]
  constexpr double kTurn = 0.02;  // [rad/s]
  for (const BackEnd backend : {BackEnd::kEkf, BackEnd::kSmoother}) {
    Options options;
    options.backend = backend;
    auto odometry = Odometry::create(options);
    test::Random random(5);
    for (int i = 0; i < 1600; ++i) {  // 8 s
      const Time t = kStart + i * kSample;
      const Vector3d rate(random.normal(1e-4), random.normal(1e-4), kTurn + random.normal(1e-4));
      const Vector3d force(random.normal(0.01), kTurn * kSpeed, 9.81 + random.normal(0.01));
      EXPECT_NE(odometry->add_imu({t, rate, force}), Status::kNumerical);
      if (i % 10 != 0) continue;
      RadarScan scan;
      scan.time = t;
      for (int k = 0; k < 12; ++k) {
        const Vector3d point_S(random.uniform(2.0, 6.0), random.uniform(-3.0, 3.0),
                               random.uniform(-2.0, 2.0));
        const double range_rate = -kSpeed * point_S.normalized().x() + random.normal(0.03);
        scan.detections.push_back({point_S, range_rate, 30.0});
      }
      (void)odometry->add_scan(scan);  // before the start it is not taken
    }
    EXPECT_TRUE(odometry->initialized());
    EXPECT_EQ(odometry->counters().velocity_resets, 1U);
    EXPECT_NEAR(odometry->now().v_WB.norm(), 1.0, 0.1);
    EXPECT_LT(std::abs(odometry->now().gyro_bias.z()), 0.5 * kTurn);
    const BodyCovariance& P = odometry->covariance();
    EXPECT_GT(std::sqrt(P(body::kGyroBias + 2, body::kGyroBias + 2)), 0.003);
  }
}

}  // namespace
}  // namespace rio::test

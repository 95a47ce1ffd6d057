// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/imu_guard.hpp"

#include <gtest/gtest.h>

#include "support/random_state.hpp"

namespace rio {
namespace {

class ImuGuardTest : public testing::Test {
 protected:
  ImuSample noisy() {
    return {Time{0}, random_.normal_vector(0.5),
            Vector3d(0.0, 0.0, 9.81) + random_.normal_vector(1.0)};
  }
  void warm_up() {
    for (int i = 0; i < 150; ++i) ASSERT_EQ(guard_.check(noisy()), ImuFault::kNone);
  }

  test::Random random_{1};
  ImuOptions options_;
  ImuGuard guard_{options_};
};

TEST_F(ImuGuardTest, WhatNoSensorReadsIsOutOfRange) {
  ImuSample s = noisy();
  s.gyro_B.x() = 1e299;  // from the first sample on
  EXPECT_EQ(guard_.check(s), ImuFault::kOutOfRange);
  warm_up();
  s = noisy();
  s.accel_B.y() = -1e4;
  EXPECT_EQ(guard_.check(s), ImuFault::kOutOfRange);
  s = noisy();
  s.gyro_B.z() = -options_.max_rate;
  EXPECT_EQ(guard_.check(s), ImuFault::kOutOfRange);
  EXPECT_EQ(guard_.check(noisy()), ImuFault::kNone);
}

TEST_F(ImuGuardTest, FrozenSamplesAreNotTaken) {
  warm_up();
  const ImuSample s = noisy();
  EXPECT_EQ(guard_.check(s), ImuFault::kNone);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(guard_.check(s), ImuFault::kFrozen);
  EXPECT_EQ(guard_.check(noisy()), ImuFault::kNone);
}

TEST_F(ImuGuardTest, AReadThatFailedIsFrozen) {
  EXPECT_EQ(guard_.check({}), ImuFault::kNone);  // so far the sensor reads nothing else
  warm_up();
  EXPECT_EQ(guard_.check({}), ImuFault::kFrozen);
  EXPECT_EQ(guard_.check(noisy()), ImuFault::kNone);
}

TEST_F(ImuGuardTest, AnAxisOrASensorThatReadsTheSameIsFrozen) {
  for (int part = 0; part < 8; ++part) {  // six axes, two sensors
    SCOPED_TRACE(part);
    guard_.reset();
    warm_up();
    const auto stuck = [&] {
      ImuSample s = noisy();
      if (part == 6) s.gyro_B.setZero();
      if (part == 7) s.accel_B.setZero();
      if (part < 6) (part < 3 ? s.gyro_B[part] : s.accel_B[part - 3]) = 0.25;
      return s;
    };
    int taken = 0;
    while (taken < 500 && guard_.check(stuck()) == ImuFault::kNone) ++taken;
    EXPECT_GE(taken, part < 6 ? 5 : 2);
    EXPECT_LE(taken, part < 6 ? 8 : 2);
    for (int i = 0; i < 500; ++i) EXPECT_EQ(guard_.check(stuck()), ImuFault::kFrozen);
    EXPECT_EQ(guard_.check(noisy()), ImuFault::kNone);
  }
}

// The accelerometer measures a quarter as often as the gyroscope.
TEST_F(ImuGuardTest, ASlowerSensorIsNotFrozen) {
  ImuSample s = noisy();
  for (int i = 0; i < 2000; ++i) {
    s.gyro_B = noisy().gyro_B;
    if (i % 4 == 0) s.accel_B = noisy().accel_B;
    ASSERT_EQ(guard_.check(s), ImuFault::kNone) << i;
  }
}

// Its noise is below its resolution: all axes repeat most of the time, some of them for long.
TEST_F(ImuGuardTest, ACoarseSensorAtRestIsNotFrozen) {
  const auto on_grid = [this](double noise) {
    constexpr double kResolution = 0.01;
    ImuSample s{Time{0}, random_.normal_vector(noise),
                Vector3d(0.0, 0.0, 9.81) + random_.normal_vector(noise)};
    for (Vector3d* v : {&s.gyro_B, &s.accel_B}) {
      *v = (*v / kResolution).array().round().matrix() * kResolution;
    }
    return s;
  };
  for (const bool first_at_rest : {true, false}) {
    guard_.reset();
    int frozen = 0;
    for (const bool at_rest : {first_at_rest, !first_at_rest, true}) {
      for (int i = 0; i < 2000; ++i) {
        frozen += guard_.check(on_grid(at_rest ? 0.003 : 0.5)) != ImuFault::kNone ? 1 : 0;
      }
    }
    // what it was not seen to repeat at first is lost where all axes do, until it is known
    EXPECT_LE(frozen, first_at_rest ? 0 : 400) << first_at_rest;
  }
}

TEST_F(ImuGuardTest, ASensorThatRepeatsItselfIsNotFrozen) {
  for (int i = 0; i < 500; ++i) {  // polled twice as fast as it measures
    const ImuSample s = noisy();
    EXPECT_EQ(guard_.check(s), ImuFault::kNone) << i;
    EXPECT_EQ(guard_.check(s), ImuFault::kNone) << i;
  }
  guard_.reset();
  for (int i = 0; i < 500; ++i) {  // without noise, at rest
    EXPECT_EQ(guard_.check({Time{0}, Vector3d::Zero(), Vector3d(0.0, 0.0, 9.81)}), ImuFault::kNone);
  }
}

// A gyroscope of 500 deg/s: its range is learned when it is reached.
TEST_F(ImuGuardTest, ALowerRangeIsLearned) {
  warm_up();
  ImuSample s = noisy();
  s.gyro_B.x() = 8.726646;
  EXPECT_EQ(guard_.check(s), ImuFault::kNone);  // once it may be true
  for (int i = 0; i < 5; ++i) {
    ImuSample more = noisy();
    more.gyro_B.x() = s.gyro_B.x();
    EXPECT_EQ(guard_.check(more), ImuFault::kOutOfRange);
  }
  // a coarse grid repeats single values, too, but not at the top of all it ever read
  s.gyro_B.x() = 5.0;
  EXPECT_EQ(guard_.check(s), ImuFault::kNone);
  ImuSample more = noisy();
  more.gyro_B.x() = 5.0;
  EXPECT_EQ(guard_.check(more), ImuFault::kNone);
}

}  // namespace
}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/imu_guard.hpp"

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

TEST_F(ImuGuardTest, HealthySamplesPass) {
  warm_up();
  for (int i = 0; i < 10000; ++i) ASSERT_EQ(guard_.check(noisy()), ImuFault::kNone) << i;
}

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

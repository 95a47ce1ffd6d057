// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/doubtful_interval.hpp"

#include <gtest/gtest.h>

namespace rio {
namespace {

constexpr double kPeriod = 0.1;  // [s]

TEST(DoubtfulInterval, LeavesTheIntegralOfThePossibleErrorOfTheVelocity) {
  DoubtfulInterval interval;
  EXPECT_EQ(interval.observe(0.0, 0.0, kPeriod), 0.0);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(interval.observe(0.5, 0.0, kPeriod), 0.0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(interval.observe(0.0, 0.4, kPeriod), 0.0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(interval.observe(0.5, 0.4, kPeriod), 0.0);
  EXPECT_NEAR(interval.observe(0.0, 0.0, kPeriod), 1.0 + 0.4 + 0.9, 1e-12);
  EXPECT_EQ(interval.observe(0.0, 0.0, kPeriod), 0.0);
}

TEST(DoubtfulInterval, AShortOneIsNotNoticed) {
  DoubtfulInterval interval;
  for (int repeat = 0; repeat < 5; ++repeat) {  // nor are several, one after the other
    for (int i = 0; i < 5; ++i) (void)interval.observe(0.4, 0.0, kPeriod);
    EXPECT_EQ(interval.observe(0.0, 0.0, kPeriod), 0.0);
  }
}

TEST(DoubtfulInterval, AReplacedVelocityAccountsForIt) {
  DoubtfulInterval interval;
  for (int i = 0; i < 20; ++i) (void)interval.observe(0.5, 0.0, kPeriod);
  interval.reset();
  EXPECT_EQ(interval.observe(0.0, 0.0, kPeriod), 0.0);
}

}  // namespace
}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/position_check.hpp"

#include <gtest/gtest.h>

namespace rio {
namespace {

constexpr double kStep = 0.1;  // [s]
constexpr Doubt kNone;

TEST(PositionCheck, LeavesTheIntegralOfThePossibleErrorOfTheVelocity) {
  PositionCheck interval;
  const Doubt velocity{.contradiction = 0.5};
  const Doubt movers{.gated = 0.4};
  const Doubt both{.contradiction = 0.5, .gated = 0.4};
  const Doubt outliers{.sigma = 0.2};
  EXPECT_EQ(interval.observe(kNone, kStep), 0.0);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(interval.observe(velocity, kStep), 0.0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(interval.observe(movers, kStep), 0.0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(interval.observe(both, kStep), 0.0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(interval.observe(outliers, kStep), 0.0);
  EXPECT_NEAR(interval.observe(kNone, kStep), 1.0 + 0.4 + 0.9 + 0.2, 1e-12);
  EXPECT_EQ(interval.observe(kNone, kStep), 0.0);
}

TEST(PositionCheck, AShortOneIsNotNoticed) {
  PositionCheck interval;
  for (int repeat = 0; repeat < 5; ++repeat) {  // nor are several, one after the other
    for (int i = 0; i < 5; ++i) (void)interval.observe({.contradiction = 0.4}, kStep);
    EXPECT_EQ(interval.observe(kNone, kStep), 0.0);
  }
}

TEST(PositionCheck, AReplacedVelocityAccountsForIt) {
  PositionCheck interval;
  for (int i = 0; i < 20; ++i) (void)interval.observe({.contradiction = 0.5}, kStep);
  interval.reset();
  EXPECT_EQ(interval.observe(kNone, kStep), 0.0);
}

}  // namespace
}  // namespace rio

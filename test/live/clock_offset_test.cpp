// SPDX-License-Identifier: BSD-3-Clause
#include "live/clock_offset.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/measured.hpp"

namespace rio::live::test {
namespace {

constexpr Time kOffset = std::chrono::hours(3);

TEST(ClockOffset, IsTheSmallestDelayInSpiteOfJitterAndDrift) {
  ClockOffset clock;
  std::mt19937 random(1);
  std::exponential_distribution<double> jitter(1.0 / 5e-3);
  Time worst{0};
  for (int i = 0; i < 200 * 120; ++i) {
    const Time stamp = i * Time(5'000'000);
    const Time truth = kOffset + stamp * 50 / 1'000'000;
    clock.add(stamp, stamp + truth + from_seconds(jitter(random)));
    if (i > 200 * 5) worst = std::max({worst, clock.offset() - truth, truth - clock.offset()});
  }
  rio::test::measured("offset of the clocks off by, ms", 1e3 * to_seconds(worst), "below 0.6");
  EXPECT_LT(worst, std::chrono::microseconds(600));
}

TEST(ClockOffset, AnOddStampCountsNotAndAJumpSoon) {
  constexpr Time kHour = std::chrono::hours(1);
  ClockOffset clock;
  EXPECT_FALSE(clock.known());
  for (int i = 0; i < 100; ++i) clock.add(Time(i), Time(i) + kOffset);
  clock.add(Time(0) + kHour, kOffset);  // once
  EXPECT_EQ(clock.offset(), kOffset);
  for (int i = 0; i < 5; ++i) clock.add(Time(i), Time(i) + kOffset + kHour);
  EXPECT_EQ(clock.offset(), kOffset + kHour);
}

}  // namespace
}  // namespace rio::live::test

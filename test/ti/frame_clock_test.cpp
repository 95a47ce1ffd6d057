// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/frame_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "rio/testing/allocation_guard.hpp"
#include "support/measured.hpp"
#include "ti/sending_radar.hpp"

namespace rio::ti::test {
namespace {

using rio::test::AllocationGuard;
using rio::test::expect_below;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(FrameClock, ExactWhereNothingIsLate) {
  SendingRadar radar(usual());
  FrameClock clock(usual());
  for (std::uint32_t n = 90; n < 500; n += 1 + n % 3) {  // with losses
    const Time stamp = clock.stamp(radar.frame(n));
    EXPECT_LT(std::abs(error_of(stamp, radar)), 1e-6) << n;
  }
  EXPECT_EQ(clock.odd() + clock.restarts(), 0);
}

// A host that reads whole packets: the time on the wire is taken off by their length.
TEST(FrameClock, TheLastByteServesWhereTheFirstIsLate) {
  SendingRadar radar(usual());
  FrameClock clock(usual());
  FrameTiming without = usual();
  without.baud = 0.0;
  FrameClock first_byte_only(without);
  for (std::uint32_t n = 0; n < 100; ++n) {
    const Frame frame = radar.frame(n, milliseconds(10));
    EXPECT_LT(std::abs(error_of(clock.stamp(frame), radar)), 1e-6);
    EXPECT_NEAR(error_of(first_byte_only.stamp(frame), radar), 0.01, 1e-6);
  }
}

/// Absolute errors [s] in five minutes with exponential jitter.
std::vector<double> errors(double mean_jitter, double drift, unsigned seed, double* drift_error) {
  SendingRadar radar(usual(), drift);
  FrameClock clock(usual());
  std::mt19937 random(seed);
  std::exponential_distribution<double> late(1.0 / mean_jitter);
  std::vector<double> errors;
  for (std::uint32_t n = 1000; n < 1000 + 4500; ++n) {
    const Time first = from_seconds(late(random));
    const Frame frame = radar.frame(n, first, first + from_seconds(late(random)));
    errors.push_back(std::abs(error_of(clock.stamp(frame), radar)));
  }
  EXPECT_EQ(clock.restarts(), 0);
  *drift_error = std::abs(clock.drift() - drift);
  return errors;
}

TEST(FrameClock, JitterOfTheHostIsTakenOffAndDriftIsFollowed) {
  constexpr long kSettled = 150;  // ten seconds
  double worst_start = 0.0, worst_drift = 0.0;
  std::vector<double> settled;
  for (unsigned seed = 0; seed < 20; ++seed) {
    double drift_error = 0.0;
    const double drift = seed % 2 == 0 ? 5e-5 : -5e-5;
    const std::vector<double> all = errors(0.005, drift, seed, &drift_error);
    worst_start = std::max(worst_start, *std::max_element(all.begin(), all.begin() + kSettled));
    settled.insert(settled.end(), all.begin() + kSettled, all.end());
    worst_drift = std::max(worst_drift, drift_error);
  }
  std::sort(settled.begin(), settled.end());
  const double median = settled[settled.size() / 2];
  const double p99 = settled[settled.size() * 99 / 100];
  expect_below("jitter 5 ms, drift 50 ppm: median stamp [ms]", 1e3 * median, 0.05);
  expect_below("  99 % after 10 s [ms]", 1e3 * p99, 0.3);
  expect_below("  worst after 10 s [ms]", 1e3 * settled.back(), 1.0);
  expect_below("  worst in the first 10 s [ms]", 1e3 * worst_start, 33.0);
  expect_below("  drift after 5 min, worst [ppm]", 1e6 * worst_drift, 10.0);
}

TEST(FrameClock, ABusyHostDelaysNoStamp) {
  SendingRadar radar(usual());
  FrameClock clock(usual());
  for (std::uint32_t n = 0; n < 400; ++n) {
    const bool busy = n % 100 > 90;  // nine frames come at once
    const Time late = busy ? (100 - n % 100) * usual().period : Time{0};
    EXPECT_LT(std::abs(error_of(clock.stamp(radar.frame(n, late, late)), radar)), 1e-6) << n;
  }
  EXPECT_EQ(clock.odd() + clock.restarts(), 0);
}

TEST(FrameClock, APauseOrASwitchOffStartsItAgain) {
  // sensorStop for a while, numbers go on; power off, numbers from 0; the clock of the host is set
  const struct {
    std::uint32_t next;
    Time pause;
  } cases[] = {{500, milliseconds(200)}, {500, seconds(5)}, {0, seconds(60)}, {500, -seconds(5)}};
  for (const auto& c : cases) {
    SendingRadar radar(usual());
    FrameClock clock(usual());
    for (std::uint32_t n = 100; n < 500; ++n) clock.stamp(radar.frame(n));
    for (std::uint32_t n = c.next; n < c.next + 100; ++n) {
      const Time stamp = clock.stamp(radar.frame(n, Time{0}, Time{0}, c.pause));
      if (n >= c.next + 17) {  // a second and one frame
        EXPECT_LT(std::abs(error_of(stamp, radar)), 1e-6) << n;
      }
    }
    EXPECT_EQ(clock.restarts(), 1) << c.pause.count();
    EXPECT_FALSE(clock.other_period()) << c.pause.count();
  }
}

TEST(FrameClock, OddNumbersAreStampedByTheirArrival) {
  SendingRadar radar(usual());
  FrameClock clock(usual());
  for (std::uint32_t n = 100; n < 500; ++n) {
    Frame frame = radar.frame(n);
    if (n % 10 == 9) frame.number ^= 1U << (n / 10 % 32);
    EXPECT_LT(std::abs(error_of(clock.stamp(frame), radar)), 1e-6) << n;
  }
  EXPECT_EQ(clock.odd(), 40);
  EXPECT_EQ(clock.restarts(), 0);
}

TEST(FrameClock, ATriggerIsTheStampOfItsFrame) {
  FrameTiming timing = usual();
  timing.trigger_delay = milliseconds(2);
  SendingRadar radar(timing);
  FrameClock clock(timing);
  std::mt19937 random(1);
  std::exponential_distribution<double> late(200.0);
  for (std::uint32_t n = 0; n < 300; ++n) {
    const Time lateness = std::min<Time>(from_seconds(late(random)), milliseconds(30));
    const Frame frame = radar.frame(n, lateness, lateness);
    const bool seen = n % 7 != 0;
    // the next trigger may come before the packet has been read
    if (seen) clock.add_trigger(radar.begun() - timing.trigger_delay);
    if (n % 7 != 6) clock.add_trigger(radar.begun() - timing.trigger_delay + timing.period);
    const double error = std::abs(error_of(clock.stamp(frame), radar));
    if (seen || n > 0) {
      EXPECT_LT(error, seen ? 2e-9 : 0.034) << n;
    }
  }
}

TEST(FrameClock, TimingsAreChecked) {
  std::string why;
  EXPECT_TRUE(usual().validate(&why));
  EXPECT_FALSE(FrameTiming{}.validate(&why));
  EXPECT_EQ(why, "period must be 1 ms to 1 h");
  const auto refused = [](auto change) {
    FrameTiming timing = usual();
    change(timing);
    return !timing.validate(nullptr);
  };
  EXPECT_TRUE(refused([](FrameTiming& t) { t.chirp_block = seconds(1); }));
  EXPECT_TRUE(refused([](FrameTiming& t) { t.processing_delay = Time{-1}; }));
  EXPECT_TRUE(refused([](FrameTiming& t) { t.trigger_delay = Time{-1}; }));
  EXPECT_TRUE(refused([](FrameTiming& t) { t.baud = std::nan(""); }));
  EXPECT_TRUE(refused([](FrameTiming& t) { t.max_drift = -1.0; }));
  EXPECT_TRUE(refused([](FrameTiming& t) { t.window = Time{-1}; }));
}

TEST(FrameClock, AllocatesNothing) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "not counted under a sanitizer";
  SendingRadar radar(usual());
  FrameClock clock(usual());
  std::mt19937 random(1);
  const AllocationGuard guard;
  for (std::uint32_t n = 0; n < 3000; ++n) {
    clock.add_trigger(radar.begun());
    const Time late(random() % 30'000'000);
    clock.stamp(radar.frame(n, late, late));
  }
  clock.reset();
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace rio::ti::test

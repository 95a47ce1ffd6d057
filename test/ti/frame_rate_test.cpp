// SPDX-License-Identifier: BSD-3-Clause
// Frames at another rate than the configured one, and what only looks like it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "rio/ti/frame_clock.hpp"
#include "support/measured.hpp"
#include "ti/sending_radar.hpp"

namespace rio::ti::test {
namespace {

using rio::test::expect_below;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

// Frames that come later and later are no busy host: none is stamped far off by the line.
TEST(FrameRate, AWrongRateIsMeasured) {
  for (const double off : {-0.5, -0.06, -0.0125, 0.0, 0.005, 0.0125, 0.06, 0.33}) {
    SendingRadar radar(usual(), off);
    FrameClock clock(usual());
    std::mt19937 random(2);
    std::exponential_distribution<double> late(200.0);
    for (std::uint32_t n = 0; n < 600; ++n) {
      const Time lateness = from_seconds(late(random));
      const int odd = clock.odd();
      const double error = error_of(clock.stamp(radar.frame(n, lateness, lateness)), radar);
      if (n < 64 || clock.odd() > odd) continue;
      EXPECT_EQ(clock.other_period().has_value(), std::abs(off) > 0.01) << off << " " << n;
      EXPECT_LT(std::abs(error), 0.5 * to_seconds(usual().period) + 0.03) << off << " " << n;
    }
    const double period = to_seconds(usual().period) * (1.0 + off);
    EXPECT_NEAR(clock.other_period().value_or(period), period, 0.003 * period) << off;
    EXPECT_EQ(clock.odd() > 20, off < -0.1 || off > 0.01) << off;
  }
}

/// Arrivals at a host that is late by 10 ms on average, sometimes by 50 ms, and that reads nothing
/// in a stall.
class SerialHost {
 public:
  explicit SerialHost(unsigned seed) : random_(seed) {}
  /// When it reads what was sent then.
  Time reads(Time sent) {
    const double mean = std::uniform_int_distribution<int>(0, 49)(random_) == 0 ? 0.05 : 0.01;
    const Time read =
        sent + from_seconds(std::exponential_distribution<double>(1.0 / mean)(random_));
    const bool stalled = read >= stall_begin && read < stall_end;
    newest_ = std::max(newest_, stalled ? stall_end : read);
    return newest_;
  }
  Time stall_begin{0};
  Time stall_end{0};

 private:
  std::mt19937 random_;
  Time newest_{0};
};

/// @return number of frames after which another period is told; 0: never
std::uint32_t told_after(Time period, double off, unsigned seed) {
  FrameTiming timing = usual();
  timing.period = period;
  SendingRadar radar(timing, off);
  FrameClock clock(timing);
  SerialHost host(seed);
  for (std::uint32_t n = 0; n < 600; ++n) {
    Frame frame = radar.frame(n);
    frame.first_arrival = frame.last_arrival = host.reads(frame.last_arrival);
    clock.stamp(frame);
    if (clock.other_period()) return n + 1;
  }
  return 0;
}

TEST(FrameRate, AWrongRateIsToldAsSoonAsItIsSignificant) {
  const struct {
    Time period;
    double off;
    std::uint32_t latest;  // frame, of 19 in 20 starts
  } cases[] = {{microseconds(66667), 0.2, 14},  {microseconds(66667), -0.2, 14},
               {microseconds(66667), 0.05, 30}, {milliseconds(100), 0.2, 14},
               {milliseconds(33), 0.2, 20},     {milliseconds(33), -0.5, 22}};
  for (const auto& c : cases) {
    std::vector<std::uint32_t> told;
    for (unsigned seed = 0; seed < 200; ++seed) told.push_back(told_after(c.period, c.off, seed));
    std::sort(told.begin(), told.end());
    SCOPED_TRACE(c.period.count());
    EXPECT_GT(told[0], 0U) << c.off;
    expect_below("frames until " + std::to_string(c.off) + " is told, 95 %", told[190], c.latest);
  }
  for (const Time period : {milliseconds(33), milliseconds(50), milliseconds(67)}) {
    for (unsigned seed = 0; seed < 200; ++seed) EXPECT_EQ(told_after(period, 1e-4, seed), 0U);
  }
}

TEST(FrameRate, AfterARestartTheNewFramesCount) {
  SendingRadar before(usual()), after(usual(), 1.0);
  FrameClock clock(usual());
  for (std::uint32_t n = 0; n < 300; ++n) clock.stamp(before.frame(n));
  EXPECT_FALSE(clock.other_period());
  std::uint32_t n = 0;
  while (n < 300 && !clock.other_period()) {
    clock.stamp(after.frame(++n, Time{0}, Time{0}, seconds(25)));
  }
  EXPECT_LT(n, 15U);
}

// The frames of a stall come at once: they tell nothing of the rate, and do not hide a wrong one.
TEST(FrameRate, AStallIsNoOtherRate) {
  for (const double off : {0.0, 0.2, -0.2}) {
    for (const int stall : {1, 2, 5, 10}) {
      for (const int begin : {1, 3, 10, 30}) {
        SendingRadar radar(usual(), off);
        FrameClock clock(usual());
        SerialHost host(static_cast<unsigned>(begin));
        host.stall_begin = radar.frame(0).last_arrival + seconds(begin);
        host.stall_end = host.stall_begin + seconds(stall);
        for (std::uint32_t n = 0; n < 900; ++n) {
          Frame frame = radar.frame(n);
          const bool before = frame.last_arrival < host.stall_begin;
          frame.first_arrival = frame.last_arrival = host.reads(frame.last_arrival);
          clock.stamp(frame);
          const bool told = clock.other_period().has_value();
          if (off == 0.0) {
            EXPECT_FALSE(told) << stall << " s after " << begin << " s, frame " << n;
          } else if (begin > 1 && (before || frame.last_arrival > host.stall_end) && n > 40) {
            EXPECT_TRUE(told) << stall << " s after " << begin << " s, frame " << n << " " << off;
          }
        }
        const double period = to_seconds(usual().period) * (1.0 + off);
        EXPECT_NEAR(clock.other_period().value_or(period), period, 0.005 * period);
      }
    }
  }
}

}  // namespace
}  // namespace rio::ti::test

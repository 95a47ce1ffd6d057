// SPDX-License-Identifier: BSD-3-Clause
// The odometry API when the IMU pauses or its clock jumps.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "api/swinging_body.hpp"
#include "rio/models/aids.hpp"

namespace rio::test {
namespace {

using std::chrono::milliseconds;

// Pauses count by their length and fade: 0.2 s are no reason for doubt, 0.8 s of 0.9 s are.
TEST_F(EngineTest, PausesOfTheImuAreToldAndForgotten) {
  auto odometry = started();
  const auto told = [&] { return odometry->health().because(HealthReason::kImuGaps); };
  const auto pause = [&](Time length) {
    next_ += length;
    feed(*odometry, next_ + milliseconds(100));
  };
  fly(*odometry, milliseconds(2000));
  pause(milliseconds(200));
  EXPECT_FALSE(told());
  fly(*odometry, milliseconds(2000));
  pause(milliseconds(400));
  pause(milliseconds(400));
  EXPECT_TRUE(told());
  fly(*odometry, milliseconds(2000));
  EXPECT_FALSE(told());
  EXPECT_EQ(odometry->counters().imu_gaps, 3U);
}

// While it lasts the scans that wait tell how long it is so far.
TEST_F(EngineTest, APauseOfTheImuCountsUpToTheNewestScan) {
  auto odometry = started();
  fly(*odometry, milliseconds(2000));
  for (const int ms : {200, 250, 350, 400}) {
    EXPECT_EQ(odometry->add_scan(scan(next_ + milliseconds(ms))), Status::kWaiting);
    EXPECT_EQ(odometry->health().because(HealthReason::kImuGaps), ms > 300) << ms;
  }
}

// Measurements of other sensors are not used before max_lag: until then a scan may come late.
TEST_F(EngineTest, OtherSensorsWaitForALateScan) {
  auto odometry = started();
  for (int i = 1; i <= 600; ++i) {  // 3 s
    const Time t = kStart + i * kSample;
    feed(*odometry, t);
    if (i % 40 == 0) {
      EXPECT_EQ(odometry->add_measurement({t, PositionModel{}, {.p_W = truth(t).p_WB}}),
                Status::kWaiting);
    }
    if (i > 200) {
      EXPECT_GE(t - odometry->at_scan().time, milliseconds(950)) << i;
      EXPECT_LE(t - odometry->at_scan().time, milliseconds(1000)) << i;
    }
  }
  EXPECT_EQ(odometry->add_scan(scan(next_ - milliseconds(900))), Status::kOk);
}

/// Clocks that are ahead of the motion.
class JumpTest : public EngineTest {
 protected:
  void feed_ahead(Odometry& odometry, Time until, Time ahead) {
    for (; next_ <= until; next_ += kSample) {
      ImuSample s = imu(next_);
      s.time += ahead;
      (void)odometry.add_imu(s);
    }
  }
  /// With scans at 20 Hz from `begin` to `end`.
  void fly_ahead(Odometry& odometry, Time begin, Time end, Time ahead) {
    for (Time t = begin; t <= end; t += milliseconds(50)) {
      feed_ahead(odometry, t + milliseconds(10), ahead);
      EXPECT_EQ(odometry.add_scan(scan(t, ahead)), Status::kOk);
    }
    EXPECT_EQ(odometry.health().state, HealthState::kOk);
  }
};

// In the time of the new clock a silence is noticed as before.
TEST_F(JumpTest, SilenceIsNoticedAfterTheClockHasJumpedBack) {
  auto odometry = started();
  fly_ahead(*odometry, kStart + milliseconds(50), kStart + milliseconds(2000), Time{0});
  const Time back = std::chrono::seconds(-9);
  feed_ahead(*odometry, kStart + milliseconds(2500), back);
  EXPECT_EQ(odometry->counters().clock_restarts, 1U);
  fly_ahead(*odometry, kStart + milliseconds(2550), kStart + milliseconds(4500), back);
  feed_ahead(*odometry, kStart + milliseconds(7000), back);
  EXPECT_EQ(odometry->health().state, HealthState::kDeadReckoning);
}

// What the IMU has measured since the last scan is not lost with its clock.
TEST_F(JumpTest, TheMotionSinceTheLastScanGoesOnInTheNewClock) {
  auto odometry = started();
  fly_ahead(*odometry, kStart + milliseconds(50), kStart + milliseconds(2000), Time{0});
  feed_ahead(*odometry, kStart + milliseconds(2300), Time{0});
  const Time end = kStart + milliseconds(2600);
  feed_ahead(*odometry, end, std::chrono::seconds(-9));
  EXPECT_EQ(odometry->counters().clock_restarts, 1U);
  EXPECT_LT((odometry->now().p_WB - truth(end).p_WB).norm(), 0.02);
}

// While the IMU pauses for longer than max_pause, the stamps of the radar go on: no clock jumped.
TEST_F(JumpTest, APauseThatTheRadarHasSeenIsNoJumpOfTheClock) {
  options_.timing.max_pause = 10.0;
  for (const bool radar : {true, false}) {
    next_ = kStart;
    auto odometry = started();
    fly_ahead(*odometry, kStart + milliseconds(50), kStart + milliseconds(2000), Time{0});
    for (int i = 41; radar && i <= 340; ++i) {
      (void)odometry->add_scan(scan(kStart + milliseconds(50 * i)));
    }
    next_ = kStart + std::chrono::seconds(17);
    feed_ahead(*odometry, next_ + milliseconds(300), Time{0});
    EXPECT_EQ(odometry->counters().clock_restarts, radar ? 0U : 1U);
    EXPECT_EQ(odometry->counters().imu_gaps, 1U);
    const BodyCovariance& P = odometry->covariance_now();
    const double heading = std::sqrt(P(body::kAttitude + 2, body::kAttitude + 2));
    EXPECT_EQ(heading > 0.5, radar) << heading;  // it may have turned by any angle
  }
}

}  // namespace
}  // namespace rio::test

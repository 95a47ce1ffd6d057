// SPDX-License-Identifier: BSD-3-Clause
// The intake of scans: steps of the radar's clock, pauses told from jumps, what is late, repeated
// or waited for.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "odometry/scan_clock.hpp"
#include "odometry/scan_intake.hpp"

namespace rio {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// Scan k of a radar of 20 Hz and an IMU of 200 Hz: measured at 50 k ms, received 10 ms later.
struct Arrival {
  Time stamp;
  Time imu;
};
Arrival usual(int k) {
  return {milliseconds(50 * k), milliseconds(50 * k + 10)};
}

/// The shift after so many scans, changed from the hundredth on.
Time shift_after(const std::function<void(int, Arrival*)>& change, int scans = 200) {
  ScanClock clock;
  for (int k = 0; k < scans; ++k) {
    Arrival a = usual(k);
    if (k >= 100) change(k, &a);
    (void)clock.corrected(a.stamp, a.imu);
  }
  return clock.shift();
}

TEST(ScanClock, FindsAStepInEitherDirection) {
  for (const Time step :
       {Time(milliseconds(300)), Time(-milliseconds(300)), Time(-seconds(5)), Time(hours(2))}) {
    EXPECT_EQ(shift_after([step](int, Arrival* a) { a->stamp += step; }), step);
  }
}

TEST(ScanClock, CorrectsFromTheFifthScanOn) {
  ScanClock clock;
  for (int k = 0; k < 120; ++k) {
    const Time step = k < 100 ? Time(0) : Time(milliseconds(300));
    const Time corrected = clock.corrected(usual(k).stamp + step, usual(k).imu);
    EXPECT_EQ(corrected, usual(k).stamp + (k < 104 ? step : Time(0))) << k;
    EXPECT_EQ(clock.stepped(), k == 104) << k;
  }
  clock.reset();
  EXPECT_EQ(clock.shift(), Time(0));
}

TEST(ScanClock, DelaysArePassedOver) {
  const auto none = [](const std::function<void(int, Arrival*)>& change) {
    EXPECT_EQ(shift_after(change), Time(0));
  };
  none([](int, Arrival* a) { a->imu += milliseconds(400); });              // late from now on
  none([](int k, Arrival* a) { a->imu += milliseconds(50 * (k % 10)); });  // in blocks
  none([](int, Arrival* a) { a->imu -= milliseconds(400); });              // the IMU is late
  none([](int, Arrival* a) { *a = {a->stamp + seconds(5), a->imu + seconds(5)}; });  // a silence
  none([](int, Arrival* a) { a->imu = usual(100).imu; });                           // the IMU stops
  none([](int k, Arrival* a) { a->stamp -= milliseconds(k % 2 == 0 ? 300 : 0); });  // repeated
  none([](int k, Arrival* a) { a->stamp += milliseconds(k < 104 ? 900 : 0); });     // four odd ones
  none([](int, Arrival* a) { a->stamp += milliseconds(90); });  // found as a time offset
  none([](int k, Arrival* a) { a->stamp += milliseconds(k % 2 == 0 ? 300 : 600); });  // no one step
  // late from now on, then an odd stamp: not taken for a step back to zero
  none([](int k, Arrival* a) {
    a->imu += milliseconds(400);
    if (k == 150) a->stamp += milliseconds(200);
  });
  // both clocks jump, and the samples of the IMU are not believed for a second
  none([](int k, Arrival* a) {
    a->stamp += seconds(30);
    a->imu = k < 120 ? usual(100).imu : a->imu + seconds(30);
  });
}

// Of the IMU alone: found as a step of the radar the other way. With both clocks, or after a pause
// of the IMU, the lag is as before; and a scan may still be on its way.
TEST(ScanClock, FindsAStepOfTheImu) {
  for (const Time step : {Time(seconds(2)), Time(-seconds(2)), Time(hours(1)), Time(-hours(1))}) {
    for (const Time radar : {Time(0), step}) {
      ScanClock clock;
      int found = 0;
      for (int k = 0; k < 200; ++k) {
        if (k == 100) clock.imu_jumped(step);
        const Time late = k == 100 ? Time(milliseconds(70)) : Time(0);
        (void)clock.corrected(usual(k).stamp + (k < 100 ? Time(0) : radar) - late,
                              usual(k).imu + (k < 100 ? Time(0) : step));
        found += clock.stepped() ? 1 : 0;
      }
      EXPECT_EQ(clock.shift(), radar - step);
      EXPECT_EQ(found, radar == step ? 0 : 1);
    }
  }
}

TEST(ScanClock, TheEndOfADelayOfTheImuIsNoStep) {
  ScanClock clock;
  for (int k = 0; k < 400; ++k) {
    if (k == 300) clock.imu_jumped(milliseconds(900));  // newer samples overtake the late ones
    const Arrival a = usual(k);
    const bool late = k >= 100 && k < 300;
    (void)clock.corrected(a.stamp,
                          late ? std::max(usual(100).imu, a.imu - milliseconds(900)) : a.imu);
  }
  EXPECT_EQ(clock.shift(), Time(0));
}

TEST(ScanClock, AJumpOfTheImuDoesNotMakeAStepOfDelays) {
  const auto none = [](const std::function<void(int, Arrival*)>& change) {
    ScanClock clock;
    for (int k = 0; k < 300; ++k) {
      Arrival a = usual(k);
      if (k == 120) clock.imu_jumped(seconds(1));  // a pause from scan 100 on
      if (k >= 100 && k < 120) a.imu = usual(100).imu;
      if (k >= 120) change(k, &a);
      (void)clock.corrected(a.stamp, a.imu);
    }
    EXPECT_EQ(clock.shift(), Time(0));
  };
  none([](int, Arrival*) {});
  none([](int k, Arrival* a) {
    a->imu += k < 140 ? seconds(1) - milliseconds(50) * (k - 120) : Time(0);
  });
  none([](int, Arrival* a) { a->imu += milliseconds(400); });
}

// The same with a radar so fast that its scans within a step of the IMU have nearly the same lag.
TEST(ScanClock, TheImuMustGoOn) {
  ScanClock clock;
  for (int k = 0; k < 400; ++k) {
    const Time jump = k < 200 ? Time(0) : Time(seconds(30));
    const Time t = milliseconds(10 * k);
    const bool believed = k < 200 || k >= 300;
    (void)clock.corrected(t + jump, believed ? t + jump : milliseconds(2000));
  }
  EXPECT_EQ(clock.shift(), Time(0));
}

// From the twentieth late scan on the radar delivers on time again: new scans overtake late ones.
TEST(ScanClock, ADelayThatEndsIsNoStep) {
  ScanClock clock;
  const auto add = [&clock](int k, int late) {
    (void)clock.corrected(usual(k).stamp, usual(k + late).imu);
  };
  for (int k = 0; k < 100; ++k) add(k, 0);
  for (int k = 100; k < 120; ++k) add(k, 18);
  for (int k = 120; k < 138; ++k) {
    add(k + 18, 0);
    add(k, 18);
  }
  for (int k = 156; k < 200; ++k) add(k, 0);
  EXPECT_EQ(clock.shift(), Time(0));
}

// One odd stamp, wherever it comes from, must not make the scans after it look irregular.
TEST(ScanClock, AnOddStampIsForgotten) {
  for (const Time odd : {Time(hours(1)), Time(-hours(1)), Time(seconds(3))}) {
    for (const bool due : {true, false}) {
      EXPECT_EQ(shift_after([&](int k, Arrival* a) {
                  if (k == 100) *a = {a->stamp + odd, due ? a->imu : a->imu + milliseconds(200)};
                  if (k >= 170) a->imu += milliseconds(400);  // late from then on
                }),
                Time(0));
    }
  }
}

TEST(ScanClock, FollowsALagThatDrifts) {
  ScanClock clock;
  for (int k = 0; k < 1000; ++k) {
    const Arrival a = usual(k);
    (void)clock.corrected(a.stamp, a.imu + Time(milliseconds(k)) / 2);
  }
  EXPECT_EQ(clock.shift(), Time(0));
  EXPECT_EQ(clock.corrected(Time::min(), seconds(60)), Time::min()) << "no stamp";
  EXPECT_EQ(clock.corrected(seconds(1), std::nullopt), Time(seconds(1))) << "no IMU";
}

TEST(StampRun, TellsAPauseFromAJump) {
  StampRun run(seconds(1));
  EXPECT_FALSE(run.goes_through(seconds(0), seconds(20)));
  for (Time t{0}; t <= seconds(20); t += milliseconds(100)) run.add(t);
  EXPECT_TRUE(run.goes_through(seconds(5), seconds(20)));
  EXPECT_TRUE(run.goes_through(seconds(-1) + milliseconds(1), milliseconds(20999)));
  EXPECT_FALSE(run.goes_through(seconds(-1), seconds(20))) << "it began later";
  EXPECT_FALSE(run.goes_through(seconds(5), seconds(21))) << "it has ended before";
  EXPECT_FALSE(run.goes_through(seconds(20), seconds(20))) << "nothing lies between";
  run.add(Time::min());  // no stamp
  EXPECT_TRUE(run.goes_through(seconds(5), seconds(20)));
  run.add(seconds(21));  // as far as a jump is
  EXPECT_FALSE(run.goes_through(seconds(5), seconds(21)));
}

// Scans of several radars arrive in any order.
TEST(StampRun, GoesOnBackwardsToo) {
  StampRun run(seconds(1));
  for (int i = 0; i < 100; ++i) run.add(milliseconds(100 * i + (i % 2 == 0 ? 250 : 0)));
  EXPECT_TRUE(run.goes_through(seconds(2), seconds(10)));
}

DetectionList scan_with(double range_rate, std::size_t radar = 0) {
  DetectionList scan;
  scan.radar = radar;
  scan.items.resize(1);
  scan.items[0].range_rate = range_rate;
  return scan;
}

TEST(ScanHistory, AScanIsTheLastOnceProcessed) {
  ScanHistory history(2, 0.1);
  EXPECT_FALSE(history.is_last(Time{0}, 0));
  history.process(milliseconds(70), 0, milliseconds(60));
  EXPECT_TRUE(history.is_last(milliseconds(70), 0));
  EXPECT_FALSE(history.is_last(milliseconds(70), 1));
  history.forget(Time{0});
  EXPECT_FALSE(history.is_last(milliseconds(70), 0));
}

TEST(ScanHistory, FollowsTheLastWhileTheEstimateIsOfItsTime) {
  ScanHistory history(2, 0.1);
  history.process(milliseconds(70), 0, milliseconds(60));
  EXPECT_TRUE(history.follows_last(milliseconds(71), 0, milliseconds(60)));
  EXPECT_FALSE(history.follows_last(milliseconds(70), 0, milliseconds(60)));
  EXPECT_FALSE(history.follows_last(milliseconds(71), 0, milliseconds(65))) << "it has moved on";
  EXPECT_FALSE(history.follows_last(milliseconds(71), 1, milliseconds(60)));
  history.process(milliseconds(72), 1, milliseconds(60));
  EXPECT_FALSE(history.follows_last(milliseconds(73), 0, milliseconds(60))) << "not the last";
}

TEST(ScanHistory, KnowsARepeatedScanOfEachRadar) {
  ScanHistory history(2, 0.1);
  EXPECT_FALSE(history.is_repeated(scan_with(0.5)));
  EXPECT_FALSE(history.is_repeated(scan_with(0.5, 1)));
  EXPECT_TRUE(history.is_repeated(scan_with(0.5)));
  EXPECT_FALSE(history.is_repeated(scan_with(0.6)));
  EXPECT_FALSE(history.is_repeated(scan_with(0.0)));
  EXPECT_FALSE(history.is_repeated(scan_with(0.0))) << "at rest scans may be alike";
  EXPECT_TRUE(history.is_repeated(scan_with(0.5, 1)));
  history.forget(Time{0});
  EXPECT_TRUE(history.is_repeated(scan_with(0.5, 1)));
  history.forget_fingerprints();
  EXPECT_FALSE(history.is_repeated(scan_with(0.5, 1)));
}

TEST(ScanHistory, OneRadarWaitsForTheImuAlone) {
  const ScanHistory history(1, 0.1);
  EXPECT_FALSE(history.is_ready(milliseconds(50), 0, milliseconds(49)));
  EXPECT_TRUE(history.is_ready(milliseconds(50), 0, milliseconds(50)));
}

TEST(ScanHistory, OfTwoRadarsEachWaitsForTheOther) {
  for (const Time epoch : {milliseconds(0), milliseconds(-1000)}) {
    const auto at = [epoch](int ms) { return epoch + milliseconds(ms); };
    ScanHistory history(2, 0.1);
    history.forget(epoch);
    history.take(0, at(50), at(55));
    EXPECT_FALSE(history.is_ready(at(50), 0, at(60)));
    EXPECT_TRUE(history.is_ready(at(50), 0, at(150))) << "long enough";
    history.take(1, at(40), at(60));
    EXPECT_FALSE(history.is_ready(at(50), 0, at(60))) << "that was an earlier one";
    for (const int instant : {49, 52}) {  // the same one, but for errors of the time offsets
      history.take(1, at(instant), at(60));
      EXPECT_TRUE(history.is_ready(at(50), 0, at(60))) << instant;
    }
  }
}

TEST(ScanHistory, ASilentRadarIsNotWaitedFor) {
  ScanHistory history(2, 0.1);
  history.forget(milliseconds(0));
  history.take(1, milliseconds(10), milliseconds(20));
  history.take(0, milliseconds(500), milliseconds(510));
  EXPECT_FALSE(history.is_ready(milliseconds(500), 0, milliseconds(519)));
  EXPECT_TRUE(history.is_ready(milliseconds(500), 0, milliseconds(520)));
}

class ScanIntakeTest : public testing::Test {
 protected:
  /// An IMU that has reached 0.9 s; no scan yet.
  void start(std::size_t radars) {
    if (radars == 2)
      options_.other_radars.push_back({options_.radar.T_BS, 0.0, 0.0, options_.radar});
    imu_.emplace(options_.timing, options_.imu);
    intake_.emplace(options_);
    reach(900);
    intake_->forget(*imu_);
  }
  void reach(int ms) { imu_->push_back({milliseconds(ms), {}, {}}); }

  /// A scan of other range rates than those before.
  Status add(int ms, std::size_t radar = 0) {
    RadarScan scan;
    scan.detections.resize(1);
    scan.detections[0].point_S = {1.0, 0.2, 0.3};
    scan.detections[0].range_rate = 0.01 * ++count_;
    const Time stamp = intake_->corrected(milliseconds(ms), radar, *imu_);
    return intake_->accept(scan, {radar, stamp, stamp}, Time{0}, *imu_, &counters_);
  }

  Options options_;
  std::optional<ImuBuffer> imu_;
  std::optional<ScanIntake> intake_;
  Counters counters_;
  int count_ = 0;
};

TEST_F(ScanIntakeTest, AScanWaitsWhereAnEarlierOneOfAnotherRadarDoes) {
  start(2);
  EXPECT_EQ(add(910), Status::kWaiting);
  EXPECT_EQ(add(930), Status::kWaiting);
  reach(950);
  EXPECT_EQ(add(920, 1), Status::kWaiting);  // by itself it would be ready
  EXPECT_TRUE(intake_->is_ready(milliseconds(920), 1, *imu_));
  ASSERT_EQ(intake_->queue().size(), 3U);
  EXPECT_EQ(intake_->queue().front().time, milliseconds(910));
}

TEST_F(ScanIntakeTest, OfOneRadarAnOlderScanOvertakesThoseThatWait) {
  start(1);
  EXPECT_EQ(add(910), Status::kWaiting);
  EXPECT_EQ(add(910), Status::kDuplicate);
  EXPECT_EQ(add(890), Status::kOk);
  EXPECT_EQ(intake_->accepted().time, milliseconds(890));
  EXPECT_EQ(intake_->queue().size(), 1U);
  intake_->processed(intake_->accepted(), milliseconds(890));
  EXPECT_EQ(add(890), Status::kDuplicate);
  EXPECT_EQ(counters_.scans_duplicate, 2U);
}

// However few they are: without its only detection it would pass for an empty one.
TEST_F(ScanIntakeTest, AScanOfNonFiniteDetectionsAloneIsRefused) {
  start(1);
  const auto accept = [this](std::size_t count) {
    RadarScan scan{milliseconds(890), {}};
    scan.detections.resize(count);
    for (RadarDetection& d : scan.detections) d.point_S.setConstant(std::nan(""));
    return intake_->accept(scan, {0, scan.time, scan.time}, Time{0}, *imu_, &counters_);
  };
  EXPECT_EQ(accept(1), Status::kNonFinite);
  EXPECT_EQ(accept(0), Status::kOk);
}

}  // namespace
}  // namespace rio

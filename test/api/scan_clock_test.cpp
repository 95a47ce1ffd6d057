// SPDX-License-Identifier: BSD-3-Clause
// Steps of the radar's clock, and of that of the IMU alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "odometry/scan_clock.hpp"

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
// of the IMU, the lag is as before. At first its samples are not believed, and a scan may still be
// on its way.
TEST(ScanClock, FindsAStepOfTheImu) {
  for (const Time step : {Time(seconds(2)), Time(-seconds(2)), Time(hours(1)), Time(-hours(1))}) {
    for (const Time radar : {Time(0), step}) {
      ScanClock clock;
      int found = 0;
      for (int k = 0; k < 200; ++k) {
        if (k == 100) clock.imu_jumped(step);
        const Time late = k == 100 ? Time(milliseconds(70)) : Time(0);
        (void)clock.corrected(usual(k).stamp + (k < 80 ? Time(0) : radar) - late,
                              k < 100 ? usual(std::min(k, 80)).imu : usual(k).imu + step);
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

}  // namespace
}  // namespace rio

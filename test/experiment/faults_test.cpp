// SPDX-License-Identifier: BSD-3-Clause
// The fault campaign: what a fault does to the events, what counts as wrong, and promises that are
// kept, with either back-end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "api/flying.hpp"
#include "experiment/survival.hpp"
#include "experiment/trial.hpp"
#include "support/measured.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {
namespace {

constexpr double kBegin = 8.0;   // in flight [s]
constexpr double kAfter = 16.0;  // [s]

const sim::Flight& flight() {
  static const sim::Flight flight = test::short_flight("indoor-1", 36.0);
  return flight;
}

Stream stream_with(const char* name) {
  return disturbed(flight(), fault_named(name), from_seconds(kBegin));
}

/// All numbers of an IMU sample or a scan; bytes would differ in the padding.
std::vector<double> numbers(const Event& e) {
  const Time stamp = e.is_imu() ? e.sample.time : e.scan.time;
  std::vector<double> all = {to_seconds(e.arrival), to_seconds(stamp)};
  for (const Vector3d& v : {e.sample.gyro_B, e.sample.accel_B}) {
    all.insert(all.end(), v.begin(), v.end());
  }
  for (const RadarDetection& d : e.scan.detections) {
    all.insert(all.end(),
               {d.point_S.x(), d.point_S.y(), d.point_S.z(), d.range_rate, d.snr_db, d.noise_db,
                d.sigma_range, d.sigma_azimuth, d.sigma_elevation, d.sigma_doppler});
  }
  return all;
}

TEST(Faults, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const Fault& fault : faults()) EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
  EXPECT_THROW((void)fault_named("nothing of the kind"), std::runtime_error);
}

TEST(Faults, NoneIsAllEventsByArrival) {
  const Stream all = stream_with("none");
  EXPECT_EQ(all.size(), flight().imu.size() + flight().scans.size());
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end(),
                             [](const Event& a, const Event& b) { return a.arrival < b.arrival; }));
}

TEST(Faults, ChangeNothingBeforeAndSomethingAfterTheirBegin) {
  const Stream none = stream_with("none");
  const Time begin = flight().imu.front().time + from_seconds(kBegin);
  for (const Fault& fault : faults()) {
    if (!fault.change) continue;
    const Stream all = disturbed(flight(), fault, from_seconds(kBegin));
    const std::size_t common = std::min(all.size(), none.size());
    std::size_t i = 0;
    while (i < common && numbers(all[i]) == numbers(none[i])) ++i;
    EXPECT_TRUE(i < common || all.size() != none.size()) << fault.name;
    if (i == common) continue;
    EXPECT_GE(std::max(all[i].arrival, none[i].arrival), begin) << fault.name;
  }
}

TEST(Faults, OfTwoTogetherEachEndsByItself) {
  const Stream all = disturbed(flight(),
                               together(fault_named("radar silent for 2 s"),
                                        fault_named("IMU silent for 0.3 s"), Promise::kBridged),
                               from_seconds(kBegin));
  const std::size_t scans = static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [](const Event& e) { return e.is_scan(); }));
  EXPECT_NEAR(static_cast<double>(flight().scans.size() - scans), 30.0, 1.0);
  EXPECT_NEAR(static_cast<double>(flight().imu.size() - (all.size() - scans)), 60.0, 1.0);
}

TEST(Deviation, IsWrongBeyondItsLimits) {
  EXPECT_EQ(Deviation{}.why(), "");
  EXPECT_EQ((Deviation{.tilt = 3.1}).why(), "tilt");
  EXPECT_EQ((Deviation{.speed = 0.51}).why(), "speed");
  EXPECT_EQ((Deviation{.position = 9.0, .position_sigmas = 4.9}).why(), "");
  EXPECT_EQ((Deviation{.position = 0.4, .position_sigmas = 9.0}).why(), "");
  EXPECT_EQ((Deviation{.position = 0.51, .position_sigmas = 5.1}).why(), "position");
  EXPECT_EQ((Deviation{.position = 1.0, .position_sigmas = std::nan("")}).why(), "position");
  EXPECT_EQ((Deviation{.age = 1.1}).why(), "stuck");
  EXPECT_EQ((Deviation{.finite = false}).why(), "not finite");
  EXPECT_EQ((Deviation{.covariance = false}).why(), "P indefinite");
  EXPECT_FALSE((Deviation{.tilt = 9.0, .tilt_sigmas = 4.9}).dishonest());
  EXPECT_TRUE((Deviation{.tilt = 9.0, .tilt_sigmas = 5.1}).dishonest());
  EXPECT_TRUE((Deviation{.velocity_sigmas = 3.1}).outside_3_sigma());
}

using FaultPromises = test::BackEndTest;

INSTANTIATE_TEST_SUITE_P(BackEnds, FaultPromises, test::kBothBackEnds, test::back_end_name);

TEST_P(FaultPromises, AreKept) {
  const char* const some[] = {
      "none",
      "all clocks start again at 0",
      "IMU samples swapped for 10 s",
      "scans again after 0.3 s",
      "IMU silent for 0.3 s",
      "radar silent for 5 s",
      "scans in blocks of 2 s for 10 s",
      "accel frozen for 5 s",
      "IMU frozen for 0.1 s",
      "one sample of 100 m/s^2",
      "vibration of 3 g and 1 rad/s for 10 s",
      "accel bias x +0.5 m/s^2",
      "empty scans for 5 s",
      "80 % random outliers for 3 s",
      "100 % random outliers for 10 s",
      "90 % movers for 10 s",
      "60 % coherent outliers for 10 s",
      "the same scan again for 10 s",
      "start in flight, 20 deg of roll off, sigma lying",
      "start in flight, 1 m/s off, sigma lying",
      "start in flight, quaternion zero",
  };
  for (const char* name : some) {
    const Fault& fault = fault_named(name);
    const Survival end = survive(flight(), options_for(flight()), fault, kBegin, kAfter);
    test::measured(std::string(name) + ": wrong until [s]", end.wrong_until, promise_text(fault));
    EXPECT_TRUE(end.kept) << name << ": wrong until " << end.wrong_until << ", in the end "
                          << end.last.why();
    EXPECT_TRUE(end.always_finite) << name;
    EXPECT_TRUE(end.always_covariance) << name;
  }
}

// Nobody knows where it flew meanwhile; the sigma has to say so.
TEST_P(FaultPromises, OfASilenceOfBothSensorsIsKept) {
  const sim::Flight longer = test::short_flight("indoor-1", 56.0);
  const Fault& fault = fault_named("IMU and radar silent for 30 s");
  const Survival end = survive(longer, options_for(longer), fault, kBegin, kAfter);
  test::expect_below(fault.name + ": position, sigmas", end.last.position_sigmas, 3.0);
  EXPECT_TRUE(end.kept) << "wrong until " << end.wrong_until << ", in the end " << end.last.why();
  EXPECT_LT(end.last.position, 60.0);  // 30 s at 2 m/s; extrapolated it is a kilometre
  EXPECT_LT(end.outside_unreported, 1.0);
  EXPECT_EQ(end.counters.clock_restarts, 0U);
  EXPECT_GE(end.counters.restarts, 1U);
}

// A spike opens the velocity, outliers then give a wrong one, and landmarks matched among them
// would settle the position 0.5 m off with a sigma of 0.04 m.
TEST(Faults, PositionAfterOutliersThatFollowASpike) {
  const sim::Flight hover = test::short_flight("hover", 54.0, 2);
  const Fault both = together(fault_named("80 % random outliers for 3 s"),
                              fault_named("one sample of 100 m/s^2"), recovered(5.0));
  const Survival end = survive(hover, options_for(hover, "default"), both);
  test::expect_below("outliers after a spike: position, sigmas", end.last.position_sigmas, 5.0);
  EXPECT_GT(end.counters.position_reopened, 0U);
  EXPECT_TRUE(end.kept) << end.last.why();
}

}  // namespace
}  // namespace rio::experiment

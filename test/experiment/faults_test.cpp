// SPDX-License-Identifier: BSD-3-Clause
// The fault campaign: what a fault does to the events, and what counts as wrong. Promises that are
// kept: api/contract_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "experiment/survival.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {
namespace {

constexpr double kBegin = 8.0;  // in flight [s]

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

}  // namespace
}  // namespace rio::experiment

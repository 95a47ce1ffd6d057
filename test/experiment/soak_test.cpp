// SPDX-License-Identifier: BSD-3-Clause
// The long run, briefly: nothing grows or drifts, it repeats to the bit, and the order in which
// samples and scans come does not matter.
#include "experiment/soak_run.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "api/flying.hpp"
#include "experiment/soak_flight.hpp"
#include "support/measured.hpp"

namespace rio::experiment {
namespace {

TEST(EndlessFlight, BeginsAndEndsEachPieceAtRestInOnePlace) {
  sim::Scenario scenario;
  EndlessFlight flight(scenario);
  for (const int minutes : {0, 10, 20}) {
    for (const double off : {-1.0, 0.0, 1.0}) {
      const Time time = scenario.start + std::chrono::minutes(minutes) + from_seconds(off);
      const NavState x = flight.truth(time);
      EXPECT_LT(x.p_WB.norm(), 1e-12);
      EXPECT_LT(x.v_WB.norm(), 1e-12);
      EXPECT_NEAR(x.q_WB.w(), 1.0, 1e-12);
    }
  }
  // no two pieces are alike
  const NavState first = flight.truth(scenario.start + std::chrono::minutes(5));
  const NavState second = flight.truth(scenario.start + std::chrono::minutes(15));
  EXPECT_GT((first.p_WB - second.p_WB).norm(), 0.01);
}

TEST(EndlessFlight, SensorsGoOnAcrossPieces) {
  sim::Scenario scenario;
  scenario.imu.rate_hz = 2.0;
  scenario.radar.rate_hz = 1.0;
  EndlessFlight flight(scenario);
  Time last = scenario.start - std::chrono::milliseconds(500);
  for (int i = 0; i < 2500; ++i) {
    const ImuSample sample = flight.next_imu();
    ASSERT_EQ(sample.time - last, std::chrono::milliseconds(500));
    ASSERT_NEAR(sample.accel_B.norm(), 9.8, 5.0);
    last = sample.time;
    while (flight.next_scan_time() < last) {
      const Time stamp = flight.next_scan_time();
      ASSERT_EQ(flight.next_scan().time, stamp);
    }
  }
}

using Soak = test::BackEndTest;

INSTANTIATE_TEST_SUITE_P(BackEnds, Soak, test::kBothBackEnds, test::back_end_name);

TEST_P(Soak, NothingGrowsOrDrifts) {
  const SoakRun run = run_soak({.backend = GetParam()});
  ASSERT_EQ(run.rows.size(), 3U);
  EXPECT_TRUE(run.finite);
  EXPECT_GT(run.scans, 850U);
  EXPECT_EQ(run.counters.scans, run.scans);
  EXPECT_EQ(run.counters.updates_failed, 0U);
  EXPECT_EQ(run.counters.imu_gaps, 0U);
  for (const SoakRow& row : run.rows) {
    EXPECT_EQ(row.asymmetry, 0.0);
    EXPECT_LT(row.norm_error, 1e-14);
    EXPECT_EQ(row.lag, 0.0);
    EXPECT_LT(row.position_error.norm(), 4.0 * row.position_sigma);
    EXPECT_GT(row.position_sigma, 0.0);
    EXPECT_LT(row.nees_velocity, 3.0);
    EXPECT_LT(row.nees_tilt, 3.0);
    EXPECT_GT(row.calibration, 0.0);
    EXPECT_LT(row.calibration, 3.0);
  }
  const double grown = run.rows.back().resident - run.rows[1].resident;
  test::expect_below("growth of memory in 20 s [MB]", grown, 1.0);
}

TEST_P(Soak, RepeatsToTheBitInAnyLegalOrder) {
  SoakSettings settings{.seconds = 15.0, .backend = GetParam()};
  const SoakRun once = run_soak(settings);
  EXPECT_EQ(run_soak(settings).hash, once.hash);
  for (const Interleaving order :
       {Interleaving::kImuFirst, Interleaving::kEarly, Interleaving::kLate}) {
    settings.interleaving = order;
    const SoakRun other = run_soak(settings);
    EXPECT_EQ(other.hash, once.hash) << static_cast<int>(order);
    EXPECT_EQ(other.counters.scans, once.counters.scans);
  }
  settings.seed = 2;
  EXPECT_NE(run_soak(settings).hash, once.hash);
}

}  // namespace
}  // namespace rio::experiment

// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights whose IMU fails for a moment, with either back-end.
#include <gtest/gtest.h>

#include <algorithm>

#include "experiment/fault.hpp"
#include "experiment/survival.hpp"
#include "mc/late_steps.hpp"
#include "support/measured.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {
namespace {

/// The flight with a fault of the IMU from `begin` after its first sample on [s].
sim::Flight faulty(sim::Flight flight, const Fault& fault, double begin) {
  const Stream events = disturbed(flight, fault, from_seconds(begin));
  flight.imu.clear();
  for (const Event& e : events) {
    if (e.is_imu()) flight.imu.push_back(e.sample);
  }
  return flight;
}

TEST(ImuFault, IsBridgedAndForgottenWithinTenSeconds) {
  const Fault one_sample = together(fault_named("one sample of 1e4 m/s^2"),
                                    fault_named("one sample of 1e299 rad/s"), Promise::kBridged);
  const struct {
    Fault fault;
    double begin;  ///< [s]
  } cases[] = {{fault_named("IMU frozen for 0.5 s"), 8.0},
               {fault_named("IMU at full scale for 0.02 s"), 8.0},
               {one_sample, 8.0},
               {fault_named("gyro bias x +0.01 rad/s"), 20.0}};
  for (const auto& [fault, begin] : cases) {
    SCOPED_TRACE(fault.name);
    LateSteps late;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const sim::Flight flight =
          faulty(test::short_flight("indoor-1", begin + 20.0, seed), fault, begin);
      for (const Variant& v : kBackEnds) {
        const Trial trial = fly(flight, options_of(flight, v));
        EXPECT_TRUE(trial.complete) << seed;
        const Counters& n = trial.counters;
        EXPECT_GT(n.imu_out_of_range + n.imu_frozen + n.attitude_resets, 0U);
        late.add(trial, flight.imu.front().time + from_seconds(begin + 10.0));
      }
    }
    test::expect_below(fault.name + ": tilt after 10 s, worst [deg]", late.tilt, 1.0);
    test::expect_below(fault.name + ": NEES of the attitude / 3", late.nees_attitude(), 3.0);
  }
}

// While the tilt is uncertain landmarks are mismatched, which turns the heading; afterwards the
// position runs away at right angles to the velocity.
TEST(ImuFault, StrongVibrationLeavesAnHonestPosition) {
  const Fault& vibration = fault_named("vibration of 3 g and 1 rad/s for 10 s");
  double worst = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const sim::Flight flight =
        test::short_flight("outdoor", kFaultBegins + vibration.duration + kJudgedAfter, seed);
    for (const Variant& v : kBackEnds) {
      const Survival end = survive(flight, options_of(flight, v), vibration);
      worst = std::max(worst, end.last.position_sigmas);
    }
  }
  test::expect_below("strong vibration for 10 s: position after 30 s [sigma], worst", worst, 3.0);
}

// Too small for a gate: only the sum of the corrections tells, after two to four seconds.
TEST(ImuFault, ASmallStepOfABiasDoesNotCarryTheEstimateAway) {
  for (const char* name : {"outdoor", "hover"}) {
    const sim::Flight flight = test::short_flight(name, kFaultBegins + kJudgedAfter + 1.0);
    for (const char* step : {"accel bias z +0.05 m/s^2", "accel bias z +0.2 m/s^2"}) {
      for (const Variant& v : kBackEnds) {
        const Survival end = survive(flight, options_of(flight, v), fault_named(step));
        test::expect_below(std::string(name) + ", " + step + ": position after 30 s [m]",
                           end.last.position, 2.0);
        EXPECT_TRUE(end.kept) << end.wrong_until;
        EXPECT_LT(end.longest_unreported, 2.0);  // until it is found; 1.4 at 0.2 m/s^2
        EXPECT_GT(end.counters.velocity_resets, 0U);
      }
    }
  }
}

// No gravity tells a heading: only landmarks that turn, scan after scan the same way.
TEST(ImuFault, AStepOfTheGyroBiasAboutTheVerticalIsFoundAndLearned) {
  constexpr double kStep = 0.01;  // of the fault [rad/s]
  LateSteps all;
  int flights = 0;
  int found = 0;
  int learned = 0;
  for (const char* name : {"indoor-1", "outdoor"}) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const sim::Flight flight = faulty(test::short_flight(name, 60.0, seed),
                                        fault_named("gyro bias z +0.01 rad/s"), 20.0);
      const Time begin = flight.imu.front().time + from_seconds(20.0);
      for (const Variant& v : kBackEnds) {
        Trial trial = fly(flight, options_of(flight, v));
        for (Step& step : trial.steps) {
          if (step.truth.time >= begin) step.truth.gyro_bias.z() += kStep;
        }
        LateSteps late;
        for (LateSteps* steps : {&late, &all}) steps->add(trial, begin + from_seconds(35.0));
        learned += late.heading_bias < 0.5 * kStep ? 1 : 0;
        found += trial.counters.attitude_resets > 0 ? 1 : 0;
        ++flights;
      }
    }
  }
  test::measured("flights whose step is found", found, "32 of 32");
  test::measured("gyro bias from 35 s on within 0.005 rad/s, flights", learned,
                 "at least 28 of 32");
  EXPECT_EQ(found, flights);
  // 30: how soon it is found depends on the landmarks in view
  EXPECT_GE(learned, flights - flights / 8);
  // 40 and more with the bias of before
  test::expect_below("NEES of the attitude / 3 from 35 s on", all.nees_attitude(), 3.0);
}

// How far the body has turned in a pause nobody knows: landmarks matched one by one after it would
// be taken for their neighbours, each well inside its gate.
TEST(ImuFault, APauseLeavesAnHonestPosition) {
  for (const double pause : {0.3, 0.6, 2.0}) {
    LateSteps late;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      sim::Flight flight = test::short_flight("indoor-1", 35.0, seed);
      const Time first = flight.imu.front().time + from_seconds(20.0);
      const Time last = first + from_seconds(pause);
      std::erase_if(flight.imu,
                    [&](const ImuSample& s) { return s.time >= first && s.time < last; });
      for (const Variant& v : kBackEnds) {
        late.add(fly(flight, options_of(flight, v)), last + from_seconds(10.0));
      }
    }
    // 34 at 0.6 s with the landmarks of before
    test::expect_below("pause of " + std::to_string(pause) + " s: NEES of the position / 3",
                       late.nees_position(), 1.5);
  }
}

}  // namespace
}  // namespace rio::experiment

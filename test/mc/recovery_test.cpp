// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights whose velocity is told wrongly, and one with a silence, with either back-end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mc/late_steps.hpp"
#include "support/measured.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {
namespace {

/// Largest error of the velocity later than one second after the start.
double late_error(const Trial& trial) {
  LateSteps late;
  late.add_after(trial, 1.0);
  return late.velocity;
}

std::vector<Case> short_cases(const std::string& name, int count) {
  std::vector<Case> cases = cases_of(name, count);
  for (Case& c : cases) c.scenario.path.length = 10.0;
  return cases;
}

TEST(Recovery, FromAWrongVelocityWithinASecond) {
  struct Row {
    const char* scenario;
    int flights;
    std::uint32_t resets;  ///< an honest sigma needs none
  };
  for (const Row& row : {Row{"wrong-velocity", 12, 1}, Row{"vague-velocity", 4, 0}}) {
    double worst = 0.0;
    run_campaign(short_cases(row.scenario, row.flights), kBackEnds, {},
                 [&](const Case& c, const Variant& v, const Trial& trial) {
                   SCOPED_TRACE(v.name + " " + c.group + " " + std::to_string(c.scenario.seed));
                   worst = std::max(worst, late_error(trial));
                   EXPECT_LT(late_error(trial), 0.2);
                   EXPECT_EQ(trial.counters.velocity_resets, row.resets);
                   EXPECT_FALSE(score(trial).lost);
                 });
    EXPECT_GT(worst, 0.0);
    test::measured(std::string(row.scenario) + ": after a second, worst [m/s]", worst, "below 0.2");
  }
}

// The start is told with a sigma of half a degree.
TEST(Recovery, FromAWrongTiltWithinTenSeconds) {
  std::vector<Case> cases;
  for (const double degrees : {10.0, 45.0}) {
    for (Case& c : cases_of("indoor-1", 3)) {
      c.scenario.max_duration = 20.0;
      c.scenario.errors.start_tilt = degrees * M_PI / 180.0;
      cases.push_back(c);
    }
  }
  LateSteps late;
  run_campaign(cases, kBackEnds, {}, [&](const Case& c, const Variant& v, const Trial& trial) {
    late.add_after(trial, 10.0);
    EXPECT_GE(trial.counters.attitude_resets, 1U) << v.name << " " << c.scenario.seed;
    LateSteps last;
    last.add(trial, trial.steps.back().truth.time);
    EXPECT_LT(last.position_sigmas, 4.0) << v.name << " " << c.scenario.seed;
  });
  test::expect_below("start tilted by 10 or 45 deg: tilt after 10 s, worst [deg]", late.tilt, 1.0);
}

// Three to six points a scan: no scan by itself tells a velocity. Two and ten metres a second
// wrong, the sigma told small or honest, the Doppler folded.
TEST(Recovery, WithAFewPointsAScan) {
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, double factor, double sigma) {
    for (Case& c : short_cases(name, 3)) {
      c.scenario.radar.max_static = 6;
      c.scenario.radar.threshold_db = 13.0;
      c.scenario.errors.start_velocity *= factor;
      if (sigma > 0.0) c.scenario.errors.start_velocity_sigma = sigma;
      cases.push_back(c);
    }
  };
  add("wrong-velocity", 1.0, 0.0);
  add("vague-velocity", 1.0, 0.0);
  add("wrong-velocity", 10.0 / std::sqrt(8.0), 0.0);
  add("vague-velocity", 10.0 / std::sqrt(8.0), 6.0);
  double worst = 0.0;
  double position = 0.0;
  run_campaign(cases, kBackEnds, {}, [&](const Case& c, const Variant& v, const Trial& trial) {
    worst = std::max(worst, late_error(trial));
    position = std::max(position, score(trial).final_error);
    EXPECT_LT(late_error(trial), 0.3) << v.name << " " << c.group << " " << c.scenario.seed;
    EXPECT_LT(score(trial).final_error, 0.5) << v.name << " " << c.group << " " << c.scenario.seed;
  });
  test::measured("few points: velocity after a second, worst [m/s]", worst, "below 0.3");
  test::measured("few points: position at the end, worst [m]", position, "below 0.5");
}

// Somebody walks before a standing radar of six points and gives most of them, for three seconds:
// coherent Dopplers, which the IMU denies.
TEST(Recovery, AStandingRadarIsNotDraggedByAPerson) {
  LateSteps all;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    sim::Scenario scenario = test::scenario_named("sparse", seed);
    scenario.path.stand_before = 14.0;
    scenario.max_duration = 13.0;
    sim::Flight flight = sim::simulate_flight(scenario);
    const Time first = flight.imu.front().time;
    for (RadarScan& scan : flight.scans) {
      const double t = to_seconds(scan.time - first);
      if (t < 6.0 || t > 9.0) continue;
      for (std::size_t i = 0; i < scan.detections.size(); ++i) {
        if (i % 4 == 0) continue;
        RadarDetection& d = scan.detections[i];
        d.range_rate += d.point_S.normalized().dot(Vector3d(0.9, 0.5, -0.1));
      }
    }
    for (const Variant& v : kBackEnds) {
      const Trial trial = fly(flight, options_of(flight, v));
      EXPECT_TRUE(trial.complete) << v.name << " " << seed;
      EXPECT_EQ(trial.counters.velocity_resets, 0U) << v.name << " " << seed;
      all.add_after(trial, 0.0);
    }
  }
  test::expect_below("person before a standing radar: position [m]", all.position, 0.3);
  test::expect_below("same, in sigmas", all.position_sigmas, 4.0);
}

// Fig. 9 of Michalczyk et al., IROS 2024, below: ten seconds at rest, told nothing of the error of
// the velocity, the published filter diverges and the published window does not.
TEST(Recovery, OfThePublishedEstimatorsTheWindowConverges) {
  std::vector<Case> cases = cases_of("wrong-velocity", 6);
  for (Case& c : cases) {
    c.scenario.path.stand_before = 11.0;
    c.scenario.max_duration = 10.0;
  }
  const std::vector<Variant> published = {{"published-ekf", "published-ekf"},
                                          {"published-smoother", "published-smoother"}};
  run_campaign(cases, published, {}, [](const Case& c, const Variant& v, const Trial& trial) {
    const Step& last = trial.steps.back();
    const double error = (last.estimate.v_WB - last.truth.v_WB).norm();
    // 3 to 14 m/s against 0.01 to 0.04 m/s
    if (v.name == "published-ekf") {
      EXPECT_GT(error, 1.0) << c.scenario.seed;
    } else {
      EXPECT_LT(error, 0.2) << c.scenario.seed;
    }
  });
}

/// The flight as an estimator sees it that is switched on after `seconds`.
sim::Flight from(sim::Flight flight, double seconds) {
  const Time begin = flight.imu.front().time + from_seconds(seconds);
  std::erase_if(flight.imu, [&](const ImuSample& s) { return s.time < begin; });
  const auto before = std::count_if(flight.scans.begin(), flight.scans.end(),
                                    [&](const RadarScan& scan) { return scan.time < begin; });
  flight.scans.erase(flight.scans.begin(), flight.scans.begin() + before);
  flight.arrivals.erase(flight.arrivals.begin(), flight.arrivals.begin() + before);
  flight.labels.erase(flight.labels.begin(), flight.labels.begin() + before);
  return flight;
}

TEST(Recovery, StartsInMotion) {
  struct Row {
    const char* flight;
    double bounds[2];  ///< of the velocity two seconds after the start, per back-end [m/s]
  };
  // the second one at up to 3.6 m/s, with folded Doppler
  for (const Row& row : {Row{"indoor-1", {0.3, 0.35}}, Row{"aggressive", {0.4, 0.9}}}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const sim::Flight flight = from(test::short_flight(row.flight, 20.0, seed), 8.0);
      for (std::size_t k = 0; k < kBackEnds.size(); ++k) {
        Options options = options_of(flight, kBackEnds[k]);
        options.start.max_wait = 1.5;
        const Trial trial = fly(flight, options);
        EXPECT_TRUE(trial.complete) << row.flight << " " << seed;
        LateSteps late;
        late.add_after(trial, 2.0);
        EXPECT_LT(late.velocity_B, row.bounds[k]) << kBackEnds[k].name << " " << seed;
      }
    }
  }
}

// Without a silence: accuracy_gate_test.cpp.
TEST(Recovery, ASilenceIsNoFalseAlarm) {
  Case dropout = cases_of("dropout", 1, 21).front();
  dropout.scenario.path.length = 50.0;
  run_campaign({dropout}, kBackEnds, {}, [](const Case&, const Variant& v, const Trial& trial) {
    EXPECT_EQ(trial.counters.velocity_resets, 0U) << v.name;
    EXPECT_EQ(trial.counters.attitude_resets, 0U) << v.name;
    EXPECT_TRUE(trial.complete) << v.name;
  });
}

}  // namespace
}  // namespace rio::experiment

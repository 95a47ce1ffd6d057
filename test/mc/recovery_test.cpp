// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights whose velocity is told wrongly, and flights in which nothing is wrong, with
// either back-end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiment/campaign.hpp"
#include "rio/eval/metrics.hpp"
#include "support/measured.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {
namespace {

const std::vector<Variant> kBackEnds = {
    {"filter", "default"},
    {"window", "default", [](Options& o) { o.backend = BackEnd::kSmoother; }}};

// Largest error of the velocity later than one second after the start.
double late_error(const Trial& trial) {
  double largest = 0.0;
  const Time start = trial.steps.front().truth.time;
  for (const Step& step : trial.steps) {
    if (to_seconds(step.truth.time - start) < 1.0) continue;
    largest = std::max(largest, (step.estimate.v_WB - step.truth.v_WB).norm());
  }
  return largest;
}

std::vector<Case> short_cases(const std::string& name, int count) {
  std::vector<Case> cases = cases_of(name, count);
  for (Case& c : cases) c.scenario.path.length = 10.0;
  return cases;
}

TEST(Recovery, FromAWrongVelocityWithinASecond) {
  int flights = 0;
  double worst = 0.0;
  run_campaign(short_cases("wrong-velocity", 12), kBackEnds, {},
               [&](const Case& c, const Variant& v, const Trial& trial) {
                 ++flights;
                 worst = std::max(worst, late_error(trial));
                 EXPECT_LT(late_error(trial), 0.2) << v.name << " " << c.scenario.seed;
                 EXPECT_EQ(trial.counters.velocity_resets, 1U) << v.name << " " << c.scenario.seed;
                 EXPECT_FALSE(score(trial).lost) << v.name << " " << c.scenario.seed;
               });
  EXPECT_EQ(flights, 24);
  test::measured("velocity after a second, worst of 24 [m/s]", worst, "below 0.2");
}

TEST(Recovery, AnHonestSigmaNeedsNone) {
  run_campaign(short_cases("vague-velocity", 4), kBackEnds, {},
               [](const Case& c, const Variant& v, const Trial& trial) {
                 EXPECT_LT(late_error(trial), 0.2) << v.name << " " << c.scenario.seed;
                 EXPECT_EQ(trial.counters.velocity_resets, 0U) << v.name << " " << c.scenario.seed;
               });
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
  double worst = 0.0;
  run_campaign(cases, kBackEnds, {}, [&](const Case& c, const Variant& v, const Trial& trial) {
    const Time start = trial.steps.front().truth.time;
    for (const Step& step : trial.steps) {
      if (to_seconds(step.truth.time - start) < 10.0) continue;
      worst = std::max(worst, eval::tilt_error(step.estimate.q_WB, step.truth.q_WB));
    }
    EXPECT_GE(trial.counters.attitude_resets, 1U) << v.name << " " << c.scenario.seed;
    const Step& last = trial.steps.back();
    const double variance = last.covariance.block<3, 3>(body::kPosition, body::kPosition).trace();
    const double error = (last.estimate.p_WB - last.truth.p_WB).norm();
    EXPECT_LT(error, 4.0 * std::sqrt(variance)) << v.name << " " << c.scenario.seed;
  });
  test::measured("start tilted by 10 or 45 deg: tilt after 10 s, worst [deg]", worst, "below 1");
  EXPECT_LT(worst, 1.0);
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
  double worst = 0.0;
  double sigmas = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    sim::Scenario scenario = cases_of("sparse", 1, seed).front().scenario;
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
      for (const Step& step : trial.steps) {
        const Vector3d e = step.estimate.p_WB - step.truth.p_WB;
        const double variance =
            step.covariance.block<3, 3>(body::kPosition, body::kPosition).trace();
        worst = std::max(worst, e.norm());
        sigmas = std::max(sigmas, e.norm() / std::sqrt(variance));
      }
    }
  }
  test::measured("person before a standing radar: position [m]", worst, "below 0.3");
  test::measured("same, in sigmas", sigmas, "below 4");
  EXPECT_LT(worst, 0.3);
  EXPECT_LT(sigmas, 4.0);
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

// The window, ten times as slow, on shorter flights.
/// Largest error of the velocity later than `settled` [s] after a start in flight, from 8 s on, of
/// an estimator that is told nothing. In the axes of the body: the heading is arbitrary.
double late_error_of_moving_start(const sim::Flight& flight, BackEnd backend, double settled) {
  Options options = options_for(flight, "default");
  options.backend = backend;
  options.start.max_wait = 1.5;
  const auto odometry = Odometry::create(options);
  double largest = 0.0;
  Time started{0};
  std::size_t scan = 0;
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    const Time now = flight.imu[i].time;
    const bool flies = to_seconds(now - flight.imu.front().time) > 8.0;
    const Status fed = flies ? odometry->add_imu(flight.imu[i]) : Status::kOk;
    EXPECT_TRUE(fed == Status::kOk || fed == Status::kMoving) << to_string(fed);
    for (; scan < flight.scans.size() && flight.scans[scan].time <= now; ++scan) {
      if (!odometry->initialized()) continue;
      const Status taken = odometry->add_scan(flight.scans[scan]);
      EXPECT_TRUE(taken == Status::kOk || taken == Status::kWaiting) << to_string(taken);
    }
    if (!odometry->initialized()) continue;
    if (started == Time{0}) started = now;
    if (to_seconds(now - started) < settled) continue;
    const NavState& estimate = odometry->now();
    const NavState& truth = flight.truth[i];
    const Vector3d v_B = estimate.q_WB.conjugate() * estimate.v_WB;
    largest = std::max(largest, (v_B - truth.q_WB.conjugate() * truth.v_WB).norm());
  }
  EXPECT_NE(started, Time{0});
  return largest;
}

TEST(Recovery, StartsInMotion) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const sim::Flight flight = test::short_flight("indoor-1", 20.0, seed);
    EXPECT_LT(late_error_of_moving_start(flight, BackEnd::kEkf, 2.0), 0.3) << seed;
    EXPECT_LT(late_error_of_moving_start(flight, BackEnd::kSmoother, 2.0), 0.35) << seed;
  }
}

TEST(Recovery, StartsInFastFlightWithFoldedDoppler) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const sim::Flight flight = test::short_flight("aggressive", 20.0, seed);  // up to 3.6 m/s
    EXPECT_LT(late_error_of_moving_start(flight, BackEnd::kEkf, 2.0), 0.4) << seed;
    EXPECT_LT(late_error_of_moving_start(flight, BackEnd::kSmoother, 2.0), 0.9) << seed;
  }
}

TEST(Recovery, NoFalseAlarm) {
  constexpr double kLongest = 50.0;  // [m]
  for (const Variant& v : kBackEnds) {
    std::vector<Case> cases;
    for (const char* name : {"indoor-1", "storm", "dropout", "people", "aggressive", "hover"}) {
      cases.push_back(cases_of(name, 1, 21).front());
      double& length = cases.back().scenario.path.length;
      length = std::min(length, kLongest);
    }
    run_campaign(cases, {v}, {}, [](const Case& c, const Variant& variant, const Trial& trial) {
      EXPECT_EQ(trial.counters.velocity_resets, 0U) << variant.name << " " << c.group;
      EXPECT_EQ(trial.counters.attitude_resets, 0U) << variant.name << " " << c.group;
      EXPECT_TRUE(trial.complete) << variant.name << " " << c.group;
    });
  }
}

}  // namespace
}  // namespace rio::experiment

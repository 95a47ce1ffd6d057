// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rio/core/so3.hpp"
#include "sim/flights.hpp"
#include "support/statistics.hpp"

namespace rio::sim {
namespace {

Scenario short_flight(std::uint64_t seed) {
  return {.seed = seed, .path = {.length = 40.0}};
}

TEST(Flight, StampsAreRegularAndNeverCoincide) {
  const Flight flight = simulate_flight(short_flight(1));
  const Time start(1'700'000'000'000'000'000);
  ASSERT_EQ(flight.imu.size(), flight.truth.size());
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    ASSERT_EQ(flight.imu[i].time, start + static_cast<std::int64_t>(i) * Time(5'000'000));
    ASSERT_EQ(flight.truth[i].time, flight.imu[i].time);
  }
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    const Time time = flight.scans[i].time;
    if (i > 0) {
      const Time period = time - flight.scans[i - 1].time;
      ASSERT_NEAR(static_cast<double>(period.count()), 1e9 / 15.0, 1.0);
    }
    ASSERT_NE((time - start).count() % 5'000'000, 0);
    ASSERT_LE(time, flight.imu.back().time);
  }
  const double duration = flight.trajectory.duration();
  EXPECT_NEAR(to_seconds(flight.imu.back().time - start), duration, 0.006);
  EXPECT_NEAR(to_seconds(flight.scans.back().time - start), duration, 0.08);
}

void expect_same_motion(const NavState& a, const NavState& b) {
  ASSERT_EQ(a.time, b.time);
  ASSERT_EQ(a.p_WB, b.p_WB);
  ASSERT_EQ(a.v_WB, b.v_WB);
  ASSERT_EQ(a.q_WB.coeffs(), b.q_WB.coeffs());
}

TEST(Flight, TruthIsTheTrajectoryWithTheLatestBiases) {
  Scenario options = short_flight(2);
  options.imu = ImuModel::ideal();
  options.imu.gyro_noise_density = options.imu.accel_noise_density = 0.0;
  options.imu.gyro_random_walk = 0.01;  // so that neighbours differ
  options.max_duration = 20.0;
  const Flight flight = simulate_flight(options);
  for (std::size_t i = 0; i < flight.truth.size(); ++i) {
    const NavState& truth = flight.truth[i];
    const Trajectory::Point point = flight.trajectory.at(truth.time);
    expect_same_motion(truth, point.nav);
    ASSERT_LT((flight.imu[i].gyro_B - truth.gyro_bias - point.gyro_B).norm(), 1e-14);
    ASSERT_LT((flight.imu[i].accel_B - truth.accel_bias - point.accel_B).norm(), 1e-14);
    for (const Time later : {Time(0), Time(1), Time(4'999'999)}) {
      const NavState state = flight.truth_at(truth.time + later);
      expect_same_motion(state, flight.trajectory.at(truth.time + later).nav);
      ASSERT_EQ(state.gyro_bias, truth.gyro_bias) << i << " + " << later.count();
      ASSERT_EQ(state.accel_bias, truth.accel_bias);
    }
  }
  EXPECT_GT(flight.truth[0].accel_bias.norm(), 0.01);
  EXPECT_NE(flight.truth.back().accel_bias, flight.truth[0].accel_bias);
  const Time start = flight.trajectory.start();
  EXPECT_EQ(flight.truth_at(start - Time(1'000'000'000)).gyro_bias, flight.truth[0].gyro_bias);
  EXPECT_EQ(flight.truth_at(start + Time(99'000'000'000)).gyro_bias, flight.truth.back().gyro_bias);
}

TEST(Flight, ScansAreAsFullAsTheRadarsAre) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Flight flight = simulate_flight({.seed = seed, .path = {.length = 130.0}});
    std::vector<double> points;
    std::vector<double> standing;
    for (const RadarScan& scan : flight.scans) {
      points.push_back(static_cast<double>(scan.detections.size()));
      if (!flight.trajectory.at(scan.time).flying) standing.push_back(points.back());
    }
    SCOPED_TRACE(seed);
    EXPECT_LE(test::array_of(points).maxCoeff(), 45.0);
    EXPECT_GT(test::mean_of(points), 20.0);
    EXPECT_LT(test::mean_of(points), 35.0);
    // near a bare patch just after take-off
    EXPECT_LE((test::array_of(points) < 8.0).cast<double>().mean(), 0.002);
    EXPECT_GT(test::mean_of(standing), 8.0);
  }
}

TEST(Flight, IsCutAtTheMaximalDuration) {
  Scenario options = short_flight(1);
  options.max_duration = 7.5;
  const Flight flight = simulate_flight(options);
  EXPECT_EQ(flight.imu.size(), 1501U);
  EXPECT_EQ(flight.imu.back().time - flight.imu.front().time, from_seconds(7.5));
  EXPECT_LE(flight.scans.back().time, flight.imu.back().time);
}

TEST(Flight, IdealHasNoOutliersNoGridsNoVibration) {
  Scenario options = Scenario::ideal();
  options.seed = 5;
  options.path.length = 40.0;
  const Flight flight = simulate_flight(options);
  for (const auto& labels : flight.labels) {
    for (const Label& label : labels) ASSERT_EQ(label.cause, Cause::kStatic);
  }
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    const Trajectory::Point point = flight.trajectory.at(flight.imu[i].time);
    const Vector3d error = flight.imu[i].accel_B - point.accel_B - flight.truth[i].accel_bias;
    // six sigmas of the white noise
    ASSERT_LT(error.cwiseAbs().maxCoeff(), 6.0 * 2e-3 * 14.142);
  }
}

TEST(Flight, MountingIsToldWronglyByTheGivenAngleAndDistance) {
  Scenario options = short_flight(1);
  options.max_duration = 1.0;
  const Pose as_told = simulate_flight(options).configured_T_BS;
  EXPECT_TRUE(as_told.rotation.isApprox(options.radar.T_BS.rotation));
  EXPECT_EQ(as_told.translation, options.radar.T_BS.translation);

  options.errors.extrinsic_angle = 0.05;
  options.errors.extrinsic_distance = 0.04;
  Vector3d angles = Vector3d::Zero();
  Vector3d offsets = Vector3d::Zero();
  constexpr int kSeeds = 40;
  for (int i = 0; i < kSeeds; ++i) {
    options.seed = static_cast<std::uint64_t>(i);
    const Pose configured = configured_mounting(options);
    const Pose& truth = options.radar.T_BS;
    const Vector3d offset = configured.translation - truth.translation;
    const Vector3d angle = quaternion_log(truth.rotation.conjugate() * configured.rotation);
    EXPECT_NEAR(angle.norm(), 0.05, 1e-12);
    EXPECT_NEAR(offset.norm(), 0.04, 1e-12);
    angles += angle.normalized() / kSeeds;
    offsets += offset.normalized() / kSeeds;
  }
  // directions all over the sphere: five standard errors, 1/sqrt(3 n) per axis, of their mean
  EXPECT_LT(angles.cwiseAbs().maxCoeff(), 5.0 / std::sqrt(3.0 * kSeeds));
  EXPECT_LT(offsets.cwiseAbs().maxCoeff(), 5.0 / std::sqrt(3.0 * kSeeds));
  options.seed = 6;
  const Flight flight = simulate_flight(options);
  EXPECT_EQ(flight.configured_T_BS.translation, configured_mounting(options).translation);
}

TEST(Flight, DoesNotDependOnTheEpoch) {
  Scenario options = short_flight(3);
  options.radar.people = 3;
  const std::vector<double> today = numbers_of(simulate_flight(options));
  options.start = Time(0);
  EXPECT_TRUE(same_bytes(today, numbers_of(simulate_flight(options))));
}

TEST(Flight, RoomHoldsThePath) {
  Scenario options = short_flight(1);
  options.path.low = {-9.0, -9.0, 0.35};
  options.path.high = {9.0, 9.0, 5.0};
  options.path.reach = {12.0, 12.0, 10.0};
  options.path.length = 120.0;
  const Flight flight = simulate_flight(options);
  double furthest = 0.0;
  for (const NavState& truth : flight.truth) {
    ASSERT_GT((truth.p_WB - flight.room.low_W).minCoeff(), 0.0);
    ASSERT_GT((flight.room.high_W - truth.p_WB).minCoeff(), 0.0);
    furthest = std::max(furthest, truth.p_WB.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(furthest, options.room.high_W.x());  // it had to grow
}

TEST(Flight, CountsItsScans) {
  Scenario scenario;
  scenario.path.length = 20.0;
  const Trajectory path = random_flight(scenario.seed, scenario.path, scenario.start);
  std::size_t calls = 0;
  std::size_t expected = 0;
  const Flight flight = simulate_flight(path, scenario, [&](std::size_t done, std::size_t all) {
    EXPECT_EQ(done, calls++);
    expected = all;
  });
  EXPECT_EQ(calls, flight.scans.size());  // none is lost
  EXPECT_NEAR(static_cast<double>(calls), static_cast<double>(expected), 2.0);
}

}  // namespace
}  // namespace rio::sim

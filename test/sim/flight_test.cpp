// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rio/core/so3.hpp"
#include "support/flight_numbers.hpp"

namespace rio::sim {
namespace {

Scenario short_flight(std::uint64_t seed) {
  Scenario options;
  options.seed = seed;
  options.path.length = 40.0;
  return options;
}

TEST(Flight, StampsAreRegularAndNeverCoincide) {
  const Flight flight = simulate_flight(short_flight(1));
  const Time start(1'700'000'000'000'000'000);
  ASSERT_EQ(flight.imu.size(), flight.truth.size());
  ASSERT_EQ(flight.scans.size(), flight.labels.size());
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
    ASSERT_EQ(flight.scans[i].detections.size(), flight.labels[i].size());
  }
  const double duration = flight.trajectory.duration();
  EXPECT_NEAR(to_seconds(flight.imu.back().time - start), duration, 0.006);
  EXPECT_NEAR(to_seconds(flight.scans.back().time - start), duration, 0.08);
}

TEST(Flight, TruthHoldsTheMotionAndTheBiases) {
  Scenario options = short_flight(2);
  options.imu = ImuModel::ideal();
  options.imu.gyro_noise_density = options.imu.accel_noise_density = 0.0;
  const Flight flight = simulate_flight(options);
  for (std::size_t i = 0; i < flight.imu.size(); i += 7) {
    const Trajectory::Point point = flight.trajectory.at(flight.imu[i].time);
    const NavState& truth = flight.truth[i];
    ASSERT_EQ(truth.p_WB, point.nav.p_WB);
    ASSERT_EQ(truth.v_WB, point.nav.v_WB);
    ASSERT_EQ(truth.q_WB.coeffs(), point.nav.q_WB.coeffs());
    ASSERT_LT((flight.imu[i].gyro_B - truth.gyro_bias - point.gyro_B).norm(), 1e-14);
    ASSERT_LT((flight.imu[i].accel_B - truth.accel_bias - point.accel_B).norm(), 1e-14);
  }
  EXPECT_GT(flight.truth[0].accel_bias.norm(), 0.01);
  EXPECT_NE(flight.truth.back().accel_bias, flight.truth[0].accel_bias);
}

TEST(Flight, ScansAreAsFullAsTheRadarsAre) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Scenario options;
    options.seed = seed;
    options.path.length = 130.0;
    const Flight flight = simulate_flight(options);
    double sum = 0.0;
    double sparse = 0.0;
    double standing = 0.0;
    int standing_scans = 0;
    for (const RadarScan& scan : flight.scans) {
      const auto n = static_cast<double>(scan.detections.size());
      EXPECT_LE(n, 45.0);
      sum += n;
      sparse += n < 8.0 ? 1.0 : 0.0;
      if (flight.trajectory.at(scan.time).flying) continue;
      standing += n;
      ++standing_scans;
    }
    const auto scans = static_cast<double>(flight.scans.size());
    EXPECT_GT(sum / scans, 20.0) << seed;
    EXPECT_LT(sum / scans, 35.0) << seed;
    EXPECT_LE(sparse / scans, 0.002) << seed;  // near a bare patch just after take-off
    EXPECT_GT(standing / standing_scans, 8.0) << seed;
  }
}

TEST(Flight, IsCutAtTheMaximalDuration) {
  Scenario options = short_flight(1);
  options.max_duration = 7.5;
  const Flight flight = simulate_flight(options);
  EXPECT_EQ(flight.imu.size(), 1501U);
  EXPECT_EQ(flight.imu.back().time - flight.imu.front().time, from_seconds(7.5));
  EXPECT_LE(flight.scans.back().time, flight.imu.back().time);
  EXPECT_EQ(test::numbers_of(flight)[0], 0.0);
}

TEST(Flight, IdealHasNoOutliersNoGridsNoVibration) {
  Scenario options = Scenario::ideal();
  options.seed = 5;
  options.path.length = 40.0;
  const Flight flight = simulate_flight(options);
  for (const auto& labels : flight.labels) {
    for (const Label& label : labels) ASSERT_EQ(label.cause, Cause::kStatic);
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    const Trajectory::Point point = flight.trajectory.at(flight.imu[i].time);
    const Vector3d error = flight.imu[i].accel_B - point.accel_B - flight.truth[i].accel_bias;
    largest = std::max(largest, error.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(largest, 6.0 * 2e-3 * 14.142);  // six sigmas of the white noise
}

TEST(Flight, TruthAtIsTheTrajectoryWithTheLatestBiases) {
  Scenario options = short_flight(2);
  options.imu.gyro_random_walk = 0.01;  // so that neighbours differ
  options.max_duration = 20.0;
  const Flight flight = simulate_flight(options);
  for (std::size_t i = 0; i < flight.truth.size(); ++i) {
    const NavState& truth = flight.truth[i];
    for (const Time later : {Time(0), Time(1), Time(4'999'999)}) {
      const NavState state = flight.truth_at(truth.time + later);
      const NavState exact = flight.trajectory.at(truth.time + later).nav;
      ASSERT_EQ(state.time, truth.time + later);
      ASSERT_EQ(state.p_WB, exact.p_WB);
      ASSERT_EQ(state.v_WB, exact.v_WB);
      ASSERT_EQ(state.q_WB.coeffs(), exact.q_WB.coeffs());
      ASSERT_EQ(state.gyro_bias, truth.gyro_bias) << i << " + " << later.count();
      ASSERT_EQ(state.accel_bias, truth.accel_bias);
    }
  }
  const Time start = flight.trajectory.start();
  EXPECT_EQ(flight.truth_at(start - Time(1'000'000'000)).gyro_bias, flight.truth[0].gyro_bias);
  EXPECT_EQ(flight.truth_at(start + Time(99'000'000'000)).gyro_bias, flight.truth.back().gyro_bias);
}

TEST(Flight, OutagesLeaveNoScans) {
  Scenario options = short_flight(1);
  const Flight whole = simulate_flight(options);
  options.disturbances.outages = {2, 5.0};
  const Flight flight = simulate_flight(options);
  const double total = flight.trajectory.duration();
  ASSERT_EQ(flight.imu.size(), whole.imu.size());
  int silences = 0;
  Time last = flight.scans.front().time;
  for (const RadarScan& scan : flight.scans) {
    const double t = to_seconds(scan.time - flight.trajectory.start());
    for (const double centre : {total / 3.0, 2.0 * total / 3.0}) {
      EXPECT_GE(std::abs(t - centre), 2.499) << t;
    }
    silences += to_seconds(scan.time - last) > 4.9 ? 1 : 0;
    last = scan.time;
  }
  EXPECT_EQ(silences, 2);
  // 10 s at 15 Hz; at either edge one scan more or less
  EXPECT_NEAR(static_cast<double>(whole.scans.size() - flight.scans.size()), 150.0, 2.0);
  EXPECT_EQ(flight.scans[0].detections.size(), whole.scans[0].detections.size());
}

TEST(Flight, BurstsAreFullOfOutliers) {
  Scenario options = short_flight(1);
  options.disturbances.bursts = {3, 4.0};
  const Flight flight = simulate_flight(options);
  const double total = flight.trajectory.duration();
  double outliers[2] = {0.0, 0.0};
  double all[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    const double t = to_seconds(flight.scans[i].time - flight.trajectory.start());
    const int burst = options.disturbances.bursts.contain(t, total) ? 1 : 0;
    for (const Label& label : flight.labels[i]) {
      const bool fixed = label.cause == Cause::kStatic || label.cause == Cause::kSpecular;
      outliers[burst] += fixed ? 0.0 : 1.0;
      all[burst] += 1.0;
    }
  }
  EXPECT_GT(outliers[1] / all[1], 0.6);  // 0.8 less those that share a cell with a stronger one
  EXPECT_LT(outliers[0] / all[0], 0.3);
}

TEST(Flight, ImuGapsLeaveNoSamplesAndTruthGoesOn) {
  Scenario options = short_flight(1);
  const Flight whole = simulate_flight(options);
  options.disturbances.imu_gaps = {2, 0.2};
  const Flight flight = simulate_flight(options);
  ASSERT_EQ(flight.truth.size(), whole.truth.size());
  for (std::size_t i = 0; i < flight.truth.size(); ++i) {
    ASSERT_EQ(flight.truth[i].time, whole.truth[i].time);
    ASSERT_EQ(flight.truth[i].p_WB, whole.truth[i].p_WB);
    ASSERT_EQ(flight.truth[i].gyro_bias, whole.truth[i].gyro_bias);
  }
  const double total = flight.trajectory.duration();
  int gaps = 0;
  for (std::size_t i = 1; i < flight.imu.size(); ++i) {
    const double silence = to_seconds(flight.imu[i].time - flight.imu[i - 1].time);
    if (silence < 0.006) continue;
    ++gaps;
    EXPECT_NEAR(silence, 0.205, 0.0051);  // 40 samples missing, give or take one at the edge
    const double middle =
        to_seconds(flight.imu[i].time - flight.trajectory.start()) - 0.5 * silence;
    EXPECT_NEAR(middle, total * gaps / 3.0, 0.006);
  }
  EXPECT_EQ(gaps, 2);
  // what is left is what it would have been
  std::size_t k = 0;
  for (const ImuSample& sample : flight.imu) {
    while (whole.imu[k].time < sample.time) ++k;
    ASSERT_EQ(sample.accel_B, whole.imu[k].accel_B);
    ASSERT_EQ(sample.gyro_B, whole.imu[k].gyro_B);
  }
}

TEST(Flight, StampsJitterAndStillIncrease) {
  Scenario options = short_flight(1);
  const Flight exact = simulate_flight(options);
  options.imu.stamp_jitter = 0.5e-3;
  const Flight flight = simulate_flight(options);
  ASSERT_EQ(flight.imu.size(), exact.imu.size());
  double mean = 0.0;
  double square = 0.0;
  double neighbours = 0.0;
  double last = 0.0;
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    const double late = to_seconds(flight.imu[i].time - exact.imu[i].time);
    mean += late;
    square += late * late;
    neighbours += late * last;
    last = late;
    ASSERT_EQ(flight.imu[i].accel_B, exact.imu[i].accel_B);  // only the stamps move
    ASSERT_EQ(flight.truth[i].time, exact.truth[i].time);
  }
  const auto n = static_cast<double>(flight.imu.size());
  ASSERT_GT(n, 10000.0);
  // five standard errors: 0.035 of the standard deviation, 0.05 sigmas of the mean
  EXPECT_NEAR(std::sqrt(square / n) / 0.5e-3, 1.0, 0.035);
  EXPECT_LT(std::abs(mean / n), 0.05 * 0.5e-3);
  EXPECT_LT(std::abs(neighbours / square), 0.05);

  // far more than half a period: clamped, so that none overtakes another
  options.imu.stamp_jitter = 0.02;
  options.max_duration = 30.0;
  const Flight wild = simulate_flight(options);
  for (std::size_t i = 1; i < wild.imu.size(); ++i) {
    ASSERT_GT(wild.imu[i].time, wild.imu[i - 1].time);
  }
}

TEST(Flight, SaturatesAtTheLimits) {
  Scenario options = short_flight(1);
  const Flight whole = simulate_flight(options);
  options.imu.gyro_limit = 0.2;
  options.imu.accel_limit = 0.5;
  const Flight flight = simulate_flight(options);
  ASSERT_EQ(flight.imu.size(), whole.imu.size());
  int clipped = 0;
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double gyro = whole.imu[i].gyro_B[axis];
      const double accel = whole.imu[i].accel_B[axis];
      ASSERT_EQ(flight.imu[i].gyro_B[axis], std::clamp(gyro, -0.2, 0.2));
      ASSERT_EQ(flight.imu[i].accel_B[axis], std::clamp(accel, -0.5, 0.5));
      clipped += std::abs(gyro) > 0.2 || std::abs(accel) > 0.5 ? 1 : 0;
    }
  }
  EXPECT_GT(clipped, 100);
}

/// Expects the same detections in the scans that both have.
void expect_same_detections(const Flight& a, const Flight& b) {
  const std::size_t common = std::min(a.scans.size(), b.scans.size());
  ASSERT_LE(std::max(a.scans.size(), b.scans.size()), common + 1);  // one more at the end
  for (std::size_t i = 0; i < common; ++i) {
    ASSERT_EQ(a.scans[i].detections.size(), b.scans[i].detections.size());
    for (std::size_t k = 0; k < a.scans[i].detections.size(); ++k) {
      ASSERT_EQ(a.scans[i].detections[k].point_S, b.scans[i].detections[k].point_S);
      ASSERT_EQ(a.scans[i].detections[k].range_rate, b.scans[i].detections[k].range_rate);
    }
  }
}

TEST(Flight, OffsetAndLatencyShiftStampsAndArrivalsOnly) {
  Scenario options = short_flight(1);
  const Flight exact = simulate_flight(options);
  for (const auto& [offset, latency] : {std::pair{30, 0}, std::pair{0, 80}}) {  // [ms]
    options.radar.stamp_offset = 1e-3 * offset;
    options.radar.latency = 1e-3 * latency;
    const Flight flight = simulate_flight(options);
    expect_same_detections(flight, exact);
    ASSERT_TRUE(offset > 0 || flight.scans.size() == exact.scans.size());
    for (std::size_t i = 0; i < flight.scans.size(); ++i) {
      ASSERT_EQ(exact.arrivals[i], exact.scans[i].time);
      ASSERT_EQ(flight.scans[i].time, exact.scans[i].time + Time(offset * 1'000'000));
      ASSERT_EQ(flight.arrivals[i], exact.arrivals[i] + Time(latency * 1'000'000));
    }
    EXPECT_LE(flight.scans.back().time, flight.imu.back().time);
  }
}

TEST(Flight, MountingIsToldWronglyByTheGivenAngleAndDistance) {
  Scenario options = short_flight(1);
  options.max_duration = 1.0;
  EXPECT_TRUE(
      simulate_flight(options).configured_T_BS.rotation.isApprox(options.radar.T_BS.rotation));
  EXPECT_EQ(simulate_flight(options).configured_T_BS.translation, options.radar.T_BS.translation);

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

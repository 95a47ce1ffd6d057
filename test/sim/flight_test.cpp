// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/flight.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace rio::sim {
namespace {

FlightOptions short_flight(std::uint64_t seed) {
  FlightOptions options;
  options.seed = seed;
  options.length_m = 40.0;
  return options;
}

/// Every number of a flight, in order.
std::vector<double> numbers(const Flight& flight) {
  std::vector<double> all;
  const auto add = [&](const Vector3d& v) { all.insert(all.end(), {v.x(), v.y(), v.z()}); };
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    all.push_back(to_seconds(flight.imu[i].time - flight.trajectory.start()));
    add(flight.imu[i].gyro_B);
    add(flight.imu[i].accel_B);
    add(flight.truth[i].p_WB);
    add(flight.truth[i].q_WB.vec());
    add(flight.truth[i].gyro_bias);
    add(flight.truth[i].accel_bias);
  }
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    all.push_back(to_seconds(flight.scans[i].time - flight.trajectory.start()));
    for (std::size_t k = 0; k < flight.labels[i].size(); ++k) {
      const RadarDetection& detection = flight.scans[i].detections[k];
      add(detection.point_S);
      add({detection.range_rate, detection.snr_db, double(flight.labels[i][k].reflector)});
    }
  }
  return all;
}

TEST(Flight, SameSeedSameBytes) {
  const std::vector<double> a = numbers(simulate_flight(short_flight(3)));
  const std::vector<double> b = numbers(simulate_flight(short_flight(3)));
  const std::vector<double> c = numbers(simulate_flight(short_flight(4)));
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
  EXPECT_NE(a, c);
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
  FlightOptions options = short_flight(2);
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
    FlightOptions options;
    options.seed = seed;
    options.length_m = 130.0;
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
  FlightOptions options = short_flight(1);
  options.max_duration = 7.5;
  const Flight flight = simulate_flight(options);
  EXPECT_EQ(flight.imu.size(), 1501U);
  EXPECT_EQ(flight.imu.back().time - flight.imu.front().time, from_seconds(7.5));
  EXPECT_LE(flight.scans.back().time, flight.imu.back().time);
  EXPECT_EQ(numbers(flight)[0], 0.0);
}

TEST(Flight, IdealHasNoOutliersNoGridsNoVibration) {
  FlightOptions options = FlightOptions::ideal();
  options.seed = 5;
  options.length_m = 40.0;
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

}  // namespace
}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
// What disturbs the sensors of a flight, compared with the same one undisturbed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rio/sim/flight.hpp"
#include "sim/flights.hpp"

namespace rio::sim {
namespace {

const Scenario kUndisturbed{.path = {.length = 40.0}};

const Flight& undisturbed() {
  static const Flight flight = simulate_flight(kUndisturbed);
  return flight;
}

/// What is left of the samples of undisturbed() is as it would have been.
void expect_part_of_undisturbed(const std::vector<ImuSample>& left) {
  const std::vector<ImuSample>& whole = undisturbed().imu;
  std::size_t k = 0;
  for (const ImuSample& sample : left) {
    while (whole.at(k).time < sample.time) ++k;
    ASSERT_EQ(sample.accel_B, whole[k].accel_B);
    ASSERT_EQ(sample.gyro_B, whole[k].gyro_B);
  }
}

/// Expects two silences of `duration` [s], centred at a third and at two thirds of the flight.
/// @param period between two items [s]
template <class Stamped>
void expect_two_silences(const Flight& flight, const std::vector<Stamped>& items, double duration,
                         double period) {
  const double total = flight.trajectory.duration();
  int silences = 0;
  for (std::size_t i = 1; i < items.size(); ++i) {
    const double silence = to_seconds(items[i].time - items[i - 1].time);
    if (silence < 1.5 * period) continue;
    ++silences;
    // one item more or less at the edges
    EXPECT_NEAR(silence, duration + period, 1.02 * period);
    const double since =
        to_seconds(items[i].time - flight.trajectory.start()) - total * silences / 3.0;
    EXPECT_GE(since, 0.5 * duration - 1e-3);
    EXPECT_LE(since - silence, -0.5 * duration + 1e-3);
  }
  EXPECT_EQ(silences, 2);
}

TEST(Disturbances, OutagesLeaveNoScans) {
  Scenario options = kUndisturbed;
  options.disturbances.outages = {2, 5.0};
  const Flight flight = simulate_flight(options);
  ASSERT_EQ(flight.imu.size(), undisturbed().imu.size());
  expect_two_silences(flight, flight.scans, 5.0, 1.0 / 15.0);
  EXPECT_EQ(flight.scans[0].detections.size(), undisturbed().scans[0].detections.size());
}

TEST(Disturbances, BurstsAreFullOfOutliers) {
  Scenario options = kUndisturbed;
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

TEST(Disturbances, ImuGapsLeaveNoSamplesAndTruthGoesOn) {
  Scenario options = kUndisturbed;
  options.disturbances.imu_gaps = {2, 0.2};
  const Flight flight = simulate_flight(options);
  ASSERT_EQ(flight.truth.size(), undisturbed().truth.size());
  for (std::size_t i = 0; i < flight.truth.size(); ++i) {
    ASSERT_EQ(flight.truth[i].time, undisturbed().truth[i].time);
    ASSERT_EQ(flight.truth[i].p_WB, undisturbed().truth[i].p_WB);
    ASSERT_EQ(flight.truth[i].gyro_bias, undisturbed().truth[i].gyro_bias);
  }
  expect_two_silences(flight, flight.imu, 0.2, 0.005);
  expect_part_of_undisturbed(flight.imu);
}

TEST(Disturbances, LostSamplesAreGoneUnlessFilled) {
  Scenario options = kUndisturbed;
  options.imu.lost_share = 0.3;
  options.imu.lost_run = 2.0;
  const std::vector<ImuSample> left = simulate_flight(options).imu;
  const auto whole = static_cast<double>(undisturbed().imu.size());
  EXPECT_NEAR(static_cast<double>(left.size()) / whole, 0.7, 0.02);
  expect_part_of_undisturbed(left);
  options.imu.lost_filled = true;
  EXPECT_EQ(simulate_flight(options).imu.size(), undisturbed().imu.size());
}

TEST(Disturbances, StampsJitterAndStillIncrease) {
  Scenario options = kUndisturbed;
  const Flight& exact = undisturbed();
  options.imu.stamp_jitter = 0.5e-3;
  const Flight flight = simulate_flight(options);
  ASSERT_EQ(flight.imu.size(), exact.imu.size());
  Eigen::ArrayXd late(static_cast<Eigen::Index>(flight.imu.size()));
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    late(static_cast<Eigen::Index>(i)) = to_seconds(flight.imu[i].time - exact.imu[i].time);
    ASSERT_EQ(flight.imu[i].accel_B, exact.imu[i].accel_B);  // only the stamps move
    ASSERT_EQ(flight.truth[i].time, exact.truth[i].time);
  }
  const Eigen::Index pairs = late.size() - 1;
  ASSERT_GT(pairs, 10000);
  // five standard errors: 0.035 of the standard deviation, 0.05 sigmas of the mean
  EXPECT_NEAR(std::sqrt(late.square().mean()) / 0.5e-3, 1.0, 0.035);
  EXPECT_LT(std::abs(late.mean()), 0.05 * 0.5e-3);
  EXPECT_LT(std::abs((late.head(pairs) * late.tail(pairs)).mean() / late.square().mean()), 0.05);

  // far more than half a period: clamped, so that none overtakes another
  options.imu.stamp_jitter = 0.02;
  options.max_duration = 30.0;
  EXPECT_TRUE(increasing(simulate_flight(options).imu));
}

TEST(Disturbances, SaturatesAtTheLimits) {
  Scenario options = kUndisturbed;
  options.imu.gyro_limit = 0.2;
  options.imu.accel_limit = 0.5;
  const Flight flight = simulate_flight(options);
  const std::vector<ImuSample>& whole = undisturbed().imu;
  ASSERT_EQ(flight.imu.size(), whole.size());
  int clipped[2] = {0, 0};
  for (std::size_t i = 0; i < whole.size(); ++i) {
    ASSERT_EQ(flight.imu[i].gyro_B, whole[i].gyro_B.cwiseMax(-0.2).cwiseMin(0.2));
    ASSERT_EQ(flight.imu[i].accel_B, whole[i].accel_B.cwiseMax(-0.5).cwiseMin(0.5));
    clipped[0] += flight.imu[i].gyro_B != whole[i].gyro_B ? 1 : 0;
    clipped[1] += flight.imu[i].accel_B != whole[i].accel_B ? 1 : 0;
  }
  EXPECT_GT(std::min(clipped[0], clipped[1]), 100);
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

TEST(Disturbances, OffsetAndLatencyShiftStampsAndArrivalsOnly) {
  Scenario options = kUndisturbed;
  const Flight& exact = undisturbed();
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

}  // namespace
}  // namespace rio::sim

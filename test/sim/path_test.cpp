// SPDX-License-Identifier: BSD-3-Clause
// Trajectories, the random flights along them, and the spells of a flight.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/sim/path.hpp"
#include "rio/sim/spells.hpp"
#include "rio/sim/trajectory.hpp"
#include "sim/flights.hpp"

namespace rio::sim {
namespace {

TEST(Trajectory, DerivativesAgreeWithDifferences) {
  const Trajectory trajectory = random_flight(3, {.length = 150.0});
  constexpr double kStep = 1e-4;
  double largest_rate = 0.0;
  for (double t = 3.9; t < trajectory.duration() - 1.9; t += 0.0371) {
    const Trajectory::Point before = trajectory.at(t - kStep);
    const Trajectory::Point point = trajectory.at(t);
    const Trajectory::Point after = trajectory.at(t + kStep);
    const Vector3d v = (after.nav.p_WB - before.nav.p_WB) / (2.0 * kStep);
    const Vector3d a = (after.nav.v_WB - before.nav.v_WB) / (2.0 * kStep);
    const Quaternion turn(before.nav.q_WB.conjugate() * after.nav.q_WB);
    const Vector3d w = quaternion_log(turn) / (2.0 * kStep);
    const Vector3d f_B = point.nav.q_WB.conjugate() * (a + 9.81 * Vector3d::UnitZ());
    // truncation kStep^2/6 times the third derivative (< 100) is 2e-7; rounding 1e-11
    ASSERT_LT((v - point.nav.v_WB).norm(), 1e-6) << t;
    ASSERT_LT((a - point.accel_W).norm(), 1e-6) << t;
    ASSERT_LT((f_B - point.accel_B).norm(), 1e-6) << t;
    ASSERT_LT((w - point.gyro_B).norm(), 1e-6) << t;
    largest_rate = std::max(largest_rate, point.gyro_B.cwiseAbs().minCoeff());
  }
  EXPECT_GT(largest_rate, 0.2);  // all three axes were exercised at once
}

TEST(Trajectory, LiesInTheBoxOfItsCorners) {
  const Trajectory trajectory = random_flight(5, {.length = 60.0});
  const Extent all = extent(trajectory);
  EXPECT_GE((all.low - trajectory.low()).minCoeff(), 0.0);
  EXPECT_GE((trajectory.high() - all.high).minCoeff(), 0.0);
  // control points lie beside the curve by no more than a step of 0.5 s at 1.43 m/s
  EXPECT_LT((all.low - trajectory.low()).maxCoeff(), 0.72);
  EXPECT_LT((trajectory.high() - all.high).maxCoeff(), 0.72);
}

TEST(Trajectory, TimeAndSecondsAreTheSameInstant) {
  const Time start(1'700'000'000'000'000'000);
  const Trajectory trajectory = random_flight(1, {.length = 30.0}, start);
  const Trajectory::Point a = trajectory.at(start + Time(7'123'456'789));
  const Trajectory::Point b = trajectory.at(7.123456789);
  EXPECT_EQ(a.nav.time, start + Time(7'123'456'789));
  EXPECT_EQ(b.nav.time, a.nav.time);
  EXPECT_LT((a.nav.p_WB - b.nav.p_WB).norm(), 1e-12);
  EXPECT_GT(a.nav.p_WB.norm(), 0.1);
}

constexpr std::uint64_t kSeeds[] = {1, 2, 3, 7, 42, 1001};

TEST(RandomFlight, StandsExactlyStillAtBothEnds) {
  const Trajectory trajectory = random_flight(2, {.length = 140.0});
  const Trajectory::Point first = trajectory.at(0.0);
  EXPECT_TRUE(first.nav.q_WB.isApprox(Quaternion::Identity(), 0.0));
  EXPECT_EQ(first.nav.p_WB, Vector3d::Zero());
  const double end = trajectory.duration();
  for (const double t : {0.0, 1.7, 4.0, end - 2.0, end - 0.5, end, end + 10.0}) {
    const Trajectory::Point point = trajectory.at(t);
    EXPECT_EQ(point.nav.v_WB, Vector3d::Zero()) << t;
    EXPECT_EQ(point.accel_W, Vector3d::Zero()) << t;
    EXPECT_EQ(point.gyro_B, Vector3d::Zero()) << t;
    EXPECT_EQ(point.accel_B, Vector3d(0.0, 0.0, 9.81)) << t;
    EXPECT_FALSE(point.flying) << t;
  }
  EXPECT_TRUE(trajectory.at(5.0).flying);
  EXPECT_LT(trajectory.at(end).nav.p_WB.norm(), 1.2);        // lands near the start ...
  EXPECT_NEAR(trajectory.at(end).nav.p_WB.z(), 0.0, 1e-12);  // ... on the ground
}

TEST(RandomFlight, KeepsItsEnvelopeForEverySeed) {
  for (const std::uint64_t seed : kSeeds) {
    const double wanted = 130.0 + static_cast<double>(seed % 46);
    const Trajectory trajectory = random_flight(seed, {.length = wanted});
    constexpr double kStep = 0.01;
    double length = 0.0;
    double yaw_min = 0.0;
    double yaw_max = 0.0;
    double time_flying = 0.0;
    Vector3d speed_sum = Vector3d::Zero();
    for (double t = 0.0; t < trajectory.duration(); t += kStep) {
      const Trajectory::Point point = trajectory.at(t);
      length += point.nav.v_WB.norm() * kStep;
      time_flying += point.flying ? kStep : 0.0;
      speed_sum += point.nav.v_WB.cwiseAbs() * kStep;
      const Vector3d x_B = point.nav.q_WB * Vector3d::UnitX();
      const double yaw = std::atan2(x_B.y(), x_B.x());
      yaw_min = std::min(yaw_min, yaw);
      yaw_max = std::max(yaw_max, yaw);
    }
    const Extent all = extent(trajectory);
    const Vector3d size = all.high - all.low;
    SCOPED_TRACE(seed);
    EXPECT_NEAR(length, wanted, 0.001 * wanted);  // the rectangle rule is this good
    EXPECT_LT(all.fastest, 1.45);
    EXPECT_GT(all.fastest, 1.3);
    EXPECT_NEAR(length / time_flying, 0.7, 0.07);
    EXPECT_TRUE((size.array() < Eigen::Array3d(6.0, 5.0, 1.7)).all()) << size;
    EXPECT_GT(size.minCoeff(), 1.4);                       // and uses it
    EXPECT_GT((speed_sum / time_flying).minCoeff(), 0.2);  // in all axes
    EXPECT_GE(all.low.z(), 0.0);
    EXPECT_GT(yaw_max, 1.4);
    EXPECT_LT(yaw_max, 1.8);
    EXPECT_LT(yaw_min, -1.4);
    EXPECT_GT(yaw_min, -1.8);
  }
}

TEST(RandomFlight, StaysInItsBox) {
  // no symmetry that could hide a mix-up of the axes or of the corners
  const PathOptions options{
      .low = {-1.0, -6.0, 0.5}, .high = {4.0, 2.0, 3.0}, .reach = {5.0, 8.0, 2.5}};
  for (const std::uint64_t seed : kSeeds) {
    const Extent all = extent(random_flight(seed, options));
    SCOPED_TRACE(seed);
    // the box reaches 1 m around the start, so that the landing lies above its floor plan
    EXPECT_GE((all.low - options.low).head<2>().minCoeff(), 0.0);
    EXPECT_GE((options.high - all.high).minCoeff(), 0.0);
    EXPECT_GE(all.low.z(), 0.0);
    EXPECT_LT(all.low.y(), -3.5);  // and uses it: further than the room's 2.5 m
    EXPECT_GT(all.high.x(), 2.5);
    EXPECT_GT(all.high.z(), 2.0);
  }
}

TEST(RandomFlight, ReachesABoxThatIsNotAboveTheStart) {
  const PathOptions options{.length = 80.0, .low = {5.0, -2.0, 1.0}, .high = {9.0, 2.0, 2.5}};
  for (const std::uint64_t seed : kSeeds) {
    const Extent all = extent(random_flight(seed, options));
    EXPECT_LE(all.high.x(), 9.0) << seed;
    EXPECT_GT(all.high.x(), 5.5) << seed;
  }
}

TEST(RandomFlight, LengthIsExactWhereverItIsGiven) {
  for (const double length : {20.0, 40.0, 127.5, 300.0}) {
    for (const std::uint64_t seed : kSeeds) {
      const Trajectory trajectory = random_flight(seed, {.length = length});
      EXPECT_NEAR(trajectory.length(), length, 1e-9 * length) << seed;
    }
  }
}

TEST(RandomFlight, LastsAsLongAsAskedWhenNoLengthIsGiven) {
  PathOptions options{.length = 0.0, .stand_before = 3.0, .stand_after = 5.0};
  for (const double duration : {20.0, 120.0}) {
    options.duration = duration;
    for (const std::uint64_t seed : kSeeds) {
      const Trajectory trajectory = random_flight(seed, options);
      const double flown = trajectory.duration() - 8.0;
      EXPECT_GT(flown, duration) << seed;
      // the leg it is on, 4 s; the diagonal of 7.8 m at 0.8 m/s; down from 1 m at 0.5 m/s; 3 s of
      // knots at the ends
      EXPECT_LT(flown, duration + 4.0 + 9.8 + 2.0 + 3.0) << seed;
    }
  }
}

TEST(RandomFlight, LevelNoseStaysAhead) {
  const Trajectory trajectory = random_flight(2, {.length = 40.0, .max_yaw = 0.0});
  for (double t = 0.0; t < trajectory.duration(); t += 0.1) {
    // y_B is normal to the heading
    ASSERT_NEAR((trajectory.at(t).nav.q_WB * Vector3d::UnitY()).x(), 0.0, 1e-12) << t;
  }
}

TEST(Spells, AreCentredOnEqualPartsOfTheFlight) {
  const struct {
    Spells spells;
    double total;
    std::vector<double> centres;
  } cases[] = {
      {{.count = 0, .duration = 3.0}, 100.0, {}},
      {{.count = 1, .duration = 3.0}, 100.0, {50.0}},
      {{.count = 3, .duration = 4.0}, 100.0, {25.0, 50.0, 75.0}},
      {{.count = 2, .duration = 5.0}, 48.0, {16.0, 32.0}},
      {{.count = 2, .duration = 0.25}, 48.0, {16.0, 32.0}},
  };
  for (const auto& [spells, total, centres] : cases) {
    const double half = 0.5 * spells.duration;
    for (int i = -10000; i < 110000; ++i) {
      const double t = (i + 0.5) * 1e-3;
      const auto is_near = [&](double centre) { return std::abs(t - centre) < half; };
      const bool inside = std::any_of(centres.begin(), centres.end(), is_near);
      ASSERT_EQ(spells.contain(t, total), inside) << spells.count << " at " << t;
    }
    for (const double centre : centres) {  // the first instant belongs to it, the last does not
      EXPECT_TRUE(spells.contain(centre - half, total));
      EXPECT_FALSE(spells.contain(centre + half, total));
    }
  }
}

}  // namespace
}  // namespace rio::sim

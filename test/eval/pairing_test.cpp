// SPDX-License-Identifier: BSD-3-Clause
// Pairs of a true and an estimated pose.
#include <gtest/gtest.h>

#include "rio/core/so3.hpp"
#include "rio/eval/pairing.hpp"

namespace rio::eval {
namespace {

using std::chrono::milliseconds;

/// A pose at `ms` whose x [m] is `x`.
StampedPose at(int ms, double x = 0.0) {
  return {milliseconds(ms), {x, 0.0, 0.0}, Quaternion::Identity()};
}

/// Of the one pair there must be.
PosePair only_pair(const Association& association) {
  EXPECT_EQ(association.pairs.size(), 1U);
  return association.pairs.empty() ? PosePair{} : association.pairs[0];
}

TEST(AssociateNearest, TakesTheNearestWithinTheLimit) {
  const Trajectory truth = {at(0, 0.0), at(100, 1.0), at(200, 2.0), at(300, 3.0)};
  const Trajectory estimate = {at(4), at(94), at(211), at(310)};
  const Association result = associate_nearest(truth, estimate);
  ASSERT_EQ(result.pairs.size(), 3U);  // 211 is 11 ms away
  EXPECT_EQ(result.pairs[0].truth.p.x(), 0.0);
  EXPECT_EQ(result.pairs[1].truth.p.x(), 1.0);
  EXPECT_EQ(result.pairs[2].truth.p.x(), 3.0);  // exactly 10 ms still counts
  EXPECT_EQ(result.pairs[2].estimate.time, milliseconds(310));
  EXPECT_EQ(result.estimates, 4U);
}

TEST(AssociateNearest, UsesEachTruePoseOnce) {
  const Trajectory truth = {at(0), at(100)};
  const Trajectory estimate = {at(95), at(98), at(103), at(108)};
  const Association result = associate_nearest(truth, estimate);
  EXPECT_EQ(only_pair(result).estimate.time, milliseconds(98));
  EXPECT_EQ(result.estimates, 4U);
}

TEST(AssociateNearest, TiesGoToTheEarlier) {
  EXPECT_EQ(only_pair(associate_nearest({at(0, 1.0), at(10, 2.0)}, {at(5)})).truth.p.x(), 1.0);
  EXPECT_EQ(only_pair(associate_nearest({at(0)}, {at(-5), at(5)})).estimate.time, milliseconds(-5));
}

TEST(AssociateNearest, SortsAndDropsDuplicates) {
  const Trajectory truth = {at(200, 2.0), at(0, 0.0), at(0, 7.0), at(100, 1.0)};
  const Trajectory estimate = {at(100, 1.5), at(100, 9.0), at(0, 0.5)};
  const Association result = associate_nearest(truth, estimate);
  ASSERT_EQ(result.pairs.size(), 2U);
  EXPECT_EQ(result.estimates, 2U);
  EXPECT_EQ(result.pairs[0].truth.p.x(), 0.0);
  EXPECT_EQ(result.pairs[0].estimate.p.x(), 0.5);
  EXPECT_EQ(result.pairs[1].estimate.p.x(), 1.5);
}

TEST(AssociateNearest, NothingInCommon) {
  EXPECT_TRUE(associate_nearest({at(0), at(100)}, {at(500), at(600)}).pairs.empty());
  EXPECT_TRUE(associate_nearest({}, {at(0)}).pairs.empty());
  EXPECT_TRUE(associate_nearest({at(0)}, {}).pairs.empty());
}

TEST(AssociateInterpolated, IsLinearInPositionAndAngle) {
  const Vector3d turn(0.2, -0.3, 0.4);
  const Quaternion start = quaternion_exp({0.5, 0.1, -2.0});
  const Trajectory truth = {{milliseconds(0), {1.0, 2.0, 3.0}, start},
                            {milliseconds(80), {5.0, 0.0, 3.0}, start * quaternion_exp(turn)}};
  const StampedPose found = only_pair(associate_interpolated(truth, {at(20)})).truth;
  EXPECT_EQ(found.time, milliseconds(20));
  // a few roundings of numbers near 5
  EXPECT_NEAR((found.p - Vector3d(2.0, 1.5, 3.0)).norm(), 0.0, 1e-14);
  const Quaternion expected = start * quaternion_exp(0.25 * turn);
  EXPECT_NEAR(quaternion_log(expected.conjugate() * found.q).norm(), 0.0, 1e-14);
}

TEST(AssociateInterpolated, TakesTheShortWayForQuaternionsOfOppositeSign) {
  const Quaternion b = quaternion_exp({0.0, 0.0, 0.2});
  const Quaternion minus_b(-b.w(), -b.x(), -b.y(), -b.z());
  const Trajectory truth = {at(0), {milliseconds(10), Vector3d::Zero(), minus_b}};
  const StampedPose found = only_pair(associate_interpolated(truth, {at(5)})).truth;
  EXPECT_NEAR(quaternion_log(quaternion_exp({0.0, 0.0, -0.1}) * found.q).norm(), 0.0, 1e-15);
}

TEST(AssociateInterpolated, NeverExtrapolatesNorCrossesAGap) {
  const Trajectory truth = {at(100, 1.0), at(200, 2.0), at(301, 3.0), at(400, 4.0)};
  const Trajectory estimate = {at(99), at(100), at(200), at(250), at(301), at(350), at(401)};
  const Association result = associate_interpolated(truth, estimate);
  ASSERT_EQ(result.pairs.size(), 4U);  // not 99 and 401 (outside), not 250 (gap of 101 ms)
  EXPECT_EQ(result.pairs[0].truth.p.x(), 1.0);
  EXPECT_EQ(result.pairs[1].truth.p.x(), 2.0);
  EXPECT_EQ(result.pairs[2].truth.p.x(), 3.0);
  EXPECT_NEAR(result.pairs[3].truth.p.x(), 3.0 + 49.0 / 99.0, 1e-14);
  EXPECT_EQ(result.estimates, 7U);
}

TEST(AssociateInterpolated, IsExactToTheNanosecondAtLargeStamps) {
  const Time epoch(1403715523912143104LL);
  const Trajectory truth = {{epoch, {0.0, 0.0, 0.0}, Quaternion::Identity()},
                            {epoch + Time(4), {4.0, 0.0, 0.0}, Quaternion::Identity()}};
  const Association result =
      associate_interpolated(truth, {{epoch + Time(1), Vector3d::Zero(), Quaternion::Identity()}});
  EXPECT_NEAR(only_pair(result).truth.p.x(), 1.0, 1e-15);
}

TEST(Associate, InterpolatesOnlyADenseTruth) {
  const Trajectory dense = {at(0, 0.0), at(50, 1.0), at(100, 2.0)};
  EXPECT_EQ(associate(dense, {at(25)}).pairs.size(), 1U);
  const Trajectory sparse = {at(0, 0.0), at(100, 1.0), at(200, 2.0)};
  EXPECT_TRUE(associate(sparse, {at(50)}).pairs.empty());
  EXPECT_EQ(associate(sparse, {at(95)}).pairs.size(), 1U);
}

TEST(Associate, InterpolatesTheEstimateAtASparseTruth) {
  Trajectory estimate;
  for (int t = 0; t <= 1000; t += 50) estimate.push_back(at(t, 0.01 * t));
  for (const int period : {100, 200, 990}) {  // with jitter, no stamp of the estimate
    Trajectory truth;
    for (int t = 7; t <= 1000; t += period) truth.push_back(at(t + t % 3, 0.01 * t));
    const Association found = associate(truth, estimate);
    ASSERT_EQ(found.pairs.size(), truth.size()) << period;
    EXPECT_EQ(found.estimates, estimate.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_EQ(found.pairs[i].truth.time, truth[i].time);
      EXPECT_EQ(found.pairs[i].estimate.time, truth[i].time);
      EXPECT_NEAR(found.pairs[i].estimate.p.x(), 1e-8 * static_cast<double>(truth[i].time.count()),
                  1e-12);
    }
  }
}

TEST(MedianInterval, IgnoresOrderAndDuplicates) {
  EXPECT_EQ(median_interval({at(300), at(0), at(0), at(10), at(20)}), milliseconds(10));
  EXPECT_EQ(median_interval({at(5)}), milliseconds(0));
}

}  // namespace
}  // namespace rio::eval

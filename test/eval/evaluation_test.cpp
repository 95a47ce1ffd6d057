// SPDX-License-Identifier: BSD-3-Clause
// The evaluation of a path, and the pairs of poses that it begins with.
#include <gtest/gtest.h>

#include <string>

#include "rio/core/so3.hpp"
#include "rio/eval/evaluation.hpp"
#include "rio/eval/pairing.hpp"
#include "support/temp_dir.hpp"

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
  EXPECT_EQ(result.unmatched(), 1U);
  EXPECT_DOUBLE_EQ(result.completeness(), 0.75);
}

TEST(AssociateNearest, UsesEachTruePoseOnce) {
  const Trajectory truth = {at(0), at(100)};
  const Trajectory estimate = {at(95), at(98), at(103), at(108)};
  const Association result = associate_nearest(truth, estimate);
  EXPECT_EQ(only_pair(result).estimate.time, milliseconds(98));
  EXPECT_EQ(result.unmatched(), 3U);
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
  EXPECT_EQ(associate_nearest({at(0)}, {}).completeness(), 0.0);
  EXPECT_EQ(associate_nearest({}, {at(0)}).unmatched(), 1U);
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
  EXPECT_EQ(result.unmatched(), 3U);
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

/// Circle of 10 m radius, 120 s at 1 m/s, a pose each 20 ms.
Trajectory circle() {
  Trajectory poses;
  for (int i = 0; i <= 6000; ++i) {
    const double angle = 0.1 * 0.02 * i;
    poses.push_back({milliseconds(20 * i),
                     {10.0 * std::cos(angle), 10.0 * std::sin(angle), 1.0},
                     quaternion_exp({0.0, 0.0, angle})});
  }
  return poses;
}

/// Each fifth pose from the 1000th on, 7 ms late, moved by T.
Trajectory estimate_of(const Trajectory& truth, const Pose& T) {
  Trajectory poses;
  for (std::size_t i = 1000; i + 1 < truth.size(); i += 5) {
    const Time time = truth[i].time + milliseconds(7);
    poses.push_back(transformed(T, interpolate(truth[i], truth[i + 1], time)));
  }
  return poses;
}

std::string message(const Trajectory& truth, const Trajectory& estimate) {
  return test::error_of([&] { (void)evaluate(truth, estimate); });
}

TEST(Evaluate, PerfectEstimateHasNoError) {
  const Trajectory truth = circle();
  const Evaluation result = evaluate(truth, estimate_of(truth, {}));
  EXPECT_EQ(result.estimates, 1000U);
  EXPECT_EQ(result.associated, 1000U);
  EXPECT_NEAR(result.duration, 99.9, 1e-12);
  EXPECT_NEAR(result.path_length, 99.9, 1e-3);  // chords of 0.1 m: short by 0.1^2 / (24 * 10^2)
  // rounding of positions of 10 m
  EXPECT_LT(result.ape_none.translation.max, 1e-13);
  EXPECT_LT(result.ape_yaw.translation.max, 1e-11);
  EXPECT_LT(result.ape_se3.translation.max, 1e-11);
  EXPECT_LT(result.rpe[2].drift.max, 1e-11);
  EXPECT_GT(result.rpe[2].drift.count, 400U);
  EXPECT_LT(result.norm_of_mae, 1e-13);
  EXPECT_LT(result.norm_of_rmse, 1e-13);
  EXPECT_LT(result.final_drift, 1e-12);
  EXPECT_TRUE(std::isnan(result.norm_of_mae_at));
}

TEST(Evaluate, AlignmentChangesWhatItShould) {
  const Trajectory truth = circle();
  const double yaw = 0.5;
  const Pose T{quaternion_exp({0.0, 0.0, yaw}), {3.0, 0.0, 4.0}};
  const Trajectory estimate = estimate_of(truth, T);
  EvaluationOptions options;
  const Evaluation none = evaluate(truth, estimate, options);
  EXPECT_GT(none.ape_none.translation.rmse, 4.0);
  EXPECT_LT(none.ape_yaw.translation.rmse, 1e-11);
  EXPECT_LT(none.ape_se3.translation.rmse, 1e-11);
  EXPECT_NEAR(none.yaw.rmse, yaw * kDegreesPerRadian, 1e-10);
  EXPECT_LT(none.rpe[0].translation.max, 1e-11);
  EXPECT_GT(none.final_drift, 4.0);
  for (const AlignmentKind kind :
       {AlignmentKind::kOrigin, AlignmentKind::kYaw, AlignmentKind::kSe3}) {
    options.alignment = kind;
    const Evaluation aligned = evaluate(truth, estimate, options);
    EXPECT_EQ(aligned.ape_none.translation.rmse, none.ape_none.translation.rmse);
    EXPECT_LT(aligned.norm_of_mae, 1e-11);
    EXPECT_LT(aligned.final_drift, 1e-10);
    EXPECT_LT(aligned.yaw.max, 1e-10);
  }
}

TEST(Evaluate, NormOfMaeAtADistance) {
  const Trajectory truth = circle();
  Trajectory estimate = estimate_of(truth, {});
  // 0.1 m per 0.1 m pose along z
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].p.z() += 0.1 * static_cast<double>(i);
  }
  EvaluationOptions options;
  options.mae_distance = 10.05;  // poses 0 to 100
  const Evaluation result = evaluate(truth, estimate, options);
  EXPECT_NEAR(result.norm_of_mae_at, 5.0, 1e-12);
  EXPECT_NEAR(result.norm_of_mae, 49.95, 1e-11);
}

TEST(Evaluate, CountsEstimatesWithoutTruth) {
  const Trajectory truth = circle();
  const Trajectory estimate = estimate_of(truth, {});
  Trajectory with_gap = truth;
  std::erase_if(with_gap, [](const StampedPose& pose) {
    return pose.time >= milliseconds(50000) && pose.time <= milliseconds(60000);
  });
  const Evaluation result = evaluate(with_gap, estimate);
  EXPECT_EQ(result.estimates, 1000U);
  EXPECT_EQ(result.associated, 900U - 1U);  // that of 60.007 s comes before the first pose left
}

TEST(StampOffset, IsThatOfTheClockAndNotNeededWithoutOne) {
  Trajectory truth = circle();  // on which a time is a yaw, so that an eight is made of it
  for (StampedPose& pose : truth) pose.p.y() *= 0.2 * pose.p.x();
  Trajectory estimate = estimate_of(truth, {quaternion_exp({0.0, 0.0, 0.4}), {3.0, -1.0, 2.0}});
  for (StampedPose& pose : estimate) pose.p.x() *= 1.003;  // drift
  const StampOffset right = best_stamp_offset(truth, estimate);
  EXPECT_LT(std::abs(to_seconds(right.offset)), 0.02);
  EXPECT_FALSE(right.is_needed()) << right.rmse << " " << right.rmse_without;
  for (const int late : {-1234, -87, 345, 1999}) {
    Trajectory other_clock = truth;
    for (StampedPose& pose : other_clock) pose.time -= milliseconds(late);
    const StampOffset found = best_stamp_offset(other_clock, estimate);
    EXPECT_LT(std::abs(to_seconds(found.offset) - 1e-3 * late), 0.02) << late;
    EXPECT_TRUE(found.is_needed()) << late << " " << found.rmse;
    EXPECT_GT(found.rmse_without, found.rmse);
  }
  EXPECT_FALSE(best_stamp_offset(truth, {}).is_needed());
  EXPECT_FALSE(best_stamp_offset({truth[0]}, estimate).is_needed());
}

TEST(StampOffset, IsNotSeenAtRest) {
  Trajectory truth;
  Trajectory estimate;
  for (int t = 0; t <= 1000; t += 5) truth.push_back(at(t));
  for (int t = 20; t <= 950; t += 66) estimate.push_back(at(t, 3e-6 * t));  // drift
  EXPECT_FALSE(best_stamp_offset(truth, estimate).is_needed());
}

TEST(StampOffset, IsNotSeenInATruthOfFiveHertz) {
  const auto flown = [](double rate, double noise) {
    Trajectory poses;
    for (int k = 0; k < 120 * rate; ++k) {
      const double t = k / rate;
      poses.push_back(
          {from_seconds(t),
           {10.0 * std::cos(0.1 * t), 2.0 * std::sin(0.2 * t), noise * std::sin(5.0 * t)},
           Quaternion::Identity()});
    }
    return poses;
  };
  const Trajectory estimate = flown(15.0, 0.05);
  EXPECT_TRUE(is_dense(estimate));
  const StampOffset found = best_stamp_offset(flown(5.0, 0.0), estimate);
  EXPECT_NEAR(found.rmse_without, 0.05 / std::sqrt(2.0), 0.002);
  EXPECT_FALSE(found.is_needed()) << found.rmse;
  Trajectory between = flown(5.0, 0.0);
  for (StampedPose& pose : between) pose.time += milliseconds(100);
  EXPECT_PRED2(test::contains, message(flown(5.0, 0.0), between), "too sparse");
}

TEST(Evaluate, SaysWhyItCannot) {
  const Trajectory truth = circle();
  const Trajectory estimate = estimate_of(truth, {});
  EXPECT_EQ(message({truth[0]}, estimate), "the truth has fewer than 2 poses");
  EXPECT_EQ(message(truth, {estimate[0]}), "the estimate has fewer than 2 poses");
  Trajectory later = estimate;
  for (StampedPose& pose : later) pose.time += std::chrono::hours(1);
  EXPECT_PRED2(test::contains, message(truth, later), "do not overlap in time");
  later[0].time = milliseconds(50);
  EXPECT_EQ(message(truth, later), "only 1 pose of the estimate has a true pose");
  EXPECT_EQ(message(truth, estimate), "");
}

}  // namespace
}  // namespace rio::eval

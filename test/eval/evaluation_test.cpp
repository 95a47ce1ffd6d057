// SPDX-License-Identifier: BSD-3-Clause
// The evaluation of a path.
#include <gtest/gtest.h>

#include <string>

#include "rio/core/so3.hpp"
#include "rio/eval/evaluation.hpp"
#include "support/temp_dir.hpp"

namespace rio::eval {
namespace {

using std::chrono::milliseconds;

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
  for (int t = 0; t <= 1000; t += 5)
    truth.push_back({milliseconds(t), Vector3d::Zero(), Quaternion::Identity()});
  for (int t = 20; t <= 950; t += 66) {
    estimate.push_back({milliseconds(t), {3e-6 * t, 0.0, 0.0}, Quaternion::Identity()});  // drift
  }
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

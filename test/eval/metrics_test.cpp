// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/metrics.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace rio::eval {
namespace {

// Positions of a few metres and angles of some degrees: errors are some 1e-15 of them.
constexpr double kRounding = 1e-12;
constexpr double kDegree = 1.0 / kDegreesPerRadian;

using Corruption = std::function<void(StampedPose*)>;
const Corruption kPerfect = [](StampedPose*) {};

/// Truth: `count` poses along x, `step` metres and 0.1 s apart; estimates: the same, corrupted.
std::vector<PosePair> straight_line(int count, double step, const Corruption& corrupt) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < count; ++i) {
    const StampedPose truth{
        std::chrono::milliseconds(100 * i), {step * i, 0.0, 0.0}, quaternion_exp({0.1, -0.2, 0.3})};
    pairs.push_back({truth, truth});
    corrupt(&pairs.back().estimate);
  }
  return pairs;
}

std::vector<PosePair> hand_made_errors() {
  std::vector<PosePair> pairs = straight_line(4, 1.0, kPerfect);
  pairs[0].estimate.p += Vector3d(1.0, 0.0, -2.0);
  pairs[1].estimate.p += Vector3d(-1.0, 2.0, 2.0);
  pairs[2].estimate.p += Vector3d(2.0, -2.0, 1.0);
  pairs[3].estimate.p += Vector3d(0.0, 0.0, 3.0);
  return pairs;
}

TEST(Statistics, ByHand) {
  const Statistics s = statistics({3.0, 1.0, 2.0, 6.0});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 3.0);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(50.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.max, 6.0);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(3.5));
  EXPECT_DOUBLE_EQ(statistics({5.0, 1.0, 2.0}).median, 2.0);
}

TEST(Statistics, OfWhatIsUnknownAreNan) {
  const Statistics s = statistics({3.0, kNan, 1.0});
  EXPECT_EQ(s.count, 3U);
  EXPECT_TRUE(std::isnan(s.rmse) && std::isnan(s.median) && std::isnan(s.max));
}

TEST(Metrics, OfNothingAreNan) {
  const Statistics s = statistics({});
  EXPECT_EQ(s.count, 0U);
  for (const double value : {s.rmse, s.mean, s.median, s.max, s.std, yaw_errors({}).rmse,
                             final_drift({}), final_drift(straight_line(3, 0.0, kPerfect))}) {
    EXPECT_TRUE(std::isnan(value));
  }
  EXPECT_EQ(path_length({}), 0.0);
}

TEST(AbsoluteError, OfAKnownYaw) {
  // turned about the origin by 60 degrees: the error at distance d is 2 d sin(30 deg) = d
  const Quaternion turn = quaternion_exp({0.0, 0.0, 60.0 * kDegree});
  const std::vector<PosePair> pairs = straight_line(5, 1.0, [&](StampedPose* pose) {
    pose->p = turn * pose->p;
    pose->q = turn * pose->q;
  });
  const AbsoluteError error = absolute_error(pairs);
  EXPECT_NEAR(error.translation.mean, 2.0, kRounding);
  EXPECT_NEAR(error.translation.max, 4.0, kRounding);
  EXPECT_NEAR(error.rotation.rmse, 60.0, kRounding);
  EXPECT_NEAR(yaw_errors(pairs).final, 60.0, kRounding);
  EXPECT_NEAR(tilt_errors(pairs).max, 0.0, kRounding);
}

TEST(RelativeError, OfAScaledPath) {
  // 2 % too long, in every piece; body axes do not matter for a norm
  const std::vector<PosePair> pairs =
      straight_line(101, 0.5, [](StampedPose* pose) { pose->p *= 1.02; });
  for (const double distance : {1.0, 10.0, 50.0}) {
    const RelativeError error = relative_error(pairs, distance);
    EXPECT_EQ(error.distance, distance);
    EXPECT_NEAR(error.translation.max, 0.02 * distance, kRounding);
    EXPECT_NEAR(error.drift.rmse, 2.0, 1e-10);
    EXPECT_NEAR(error.rotation.max, 0.0, kRounding);
  }
  // all pieces that fit, and those cut short at the end by at most 10 %
  EXPECT_EQ(relative_error(pairs, 1.0).translation.count, 99U);
  EXPECT_EQ(relative_error(pairs, 10.0).translation.count, 81U + 2U);
  EXPECT_EQ(relative_error(pairs, 50.0).translation.count, 1U + 10U);
  EXPECT_EQ(relative_error(pairs, 60.0).translation.count, 0U);
  EXPECT_TRUE(std::isnan(relative_error(pairs, 60.0).drift.rmse));
}

TEST(RelativeError, OfAConstantYawRate) {
  // the estimated heading turns by 0.2 deg per metre while the position stays true
  std::vector<PosePair> pairs = straight_line(41, 0.5, kPerfect);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double yaw = 0.2 * kDegree * 0.5 * static_cast<double>(i);
    pairs[i].estimate.q = quaternion_exp({0.0, 0.0, yaw}) * pairs[i].truth.q;
  }
  const RelativeError error = relative_error(pairs, 10.0, 0.01);
  EXPECT_EQ(error.rotation.count, 21U);
  EXPECT_NEAR(error.rotation.mean, 2.0, kRounding);
  EXPECT_NEAR(error.rotation_per_metre.max, 0.2, kRounding);
  // a piece of d = 10 m that starts with heading error a is seen turned by -a: 2 d sin(a/2), and a
  // is at most 2 deg, at 10 m
  EXPECT_NEAR(error.translation.max, 20.0 * std::sin(1.0 * kDegree), kRounding);
}

TEST(RelativeError, DoesNotSeeARigidMotion) {
  const Pose T{quaternion_exp({0.5, -1.0, 2.0}), {10.0, 20.0, 30.0}};
  std::vector<PosePair> pairs = straight_line(41, 0.5, kPerfect);
  for (PosePair& pair : pairs) {
    pair.truth.q = pair.truth.q * quaternion_exp(pair.truth.p.x() * Vector3d(0.1, -0.2, 0.3));
    pair.estimate.p = T.rotation * pair.truth.p + T.translation;
    pair.estimate.q = T.rotation * pair.truth.q;
  }
  EXPECT_NEAR(relative_error(pairs, 10.0).translation.max, 0.0, kRounding);
  EXPECT_NEAR(relative_error(pairs, 10.0).rotation.max, 0.0, kRounding);
}

TEST(RelativeError, TakesTheNearestEndAndTheFirstWhileHovering) {
  // true path at 0, 0.6, 0.95, 0.95, 1.7 m: from 0 to the first 0.95, from 0.6 to 1.7; from 0.95 on
  // nothing is within 11 % of 1 m
  std::vector<PosePair> pairs = straight_line(5, 1.0, kPerfect);
  const double x[] = {0.0, 0.6, 0.95, 0.95, 1.7};
  for (std::size_t i = 0; i < 5; ++i) pairs[i].truth.p = pairs[i].estimate.p = {x[i], 0.0, 0.0};
  pairs[2].estimate.p.y() = 0.19;
  pairs[3].estimate.p.y() = 9.0;
  const RelativeError error = relative_error(pairs, 1.0, 0.11);
  ASSERT_EQ(error.translation.count, 2U);
  EXPECT_NEAR(error.translation.max, 0.19, kRounding);
  EXPECT_NEAR(error.drift.max, 20.0, 1e-10);  // over the true length of the piece
}

TEST(NormOfMae, ByHandAndUpToADistance) {
  const std::vector<PosePair> pairs = hand_made_errors();  // true path 0, 1, 2, 3 m
  // per axis: x (1+1+2+0)/4, y (0+2+2+0)/4, z (2+2+1+3)/4
  EXPECT_NEAR(norm_of_mae(pairs), Vector3d(1.0, 1.0, 2.0).norm(), kRounding);
  EXPECT_NEAR(norm_of_mae(pairs, 1.0), Vector3d(1.0, 1.0, 2.0).norm(), kRounding);
  EXPECT_NEAR(norm_of_mae(pairs, 1.5), Vector3d(1.0, 1.0, 2.0).norm(), kRounding);
  EXPECT_NEAR(norm_of_mae(pairs, 2.0), Vector3d(4.0, 4.0, 5.0).norm() / 3.0, kRounding);
  EXPECT_NEAR(norm_of_mae(pairs, 3.0), norm_of_mae(pairs), kRounding);
  EXPECT_TRUE(std::isnan(norm_of_mae(pairs, 3.1)));
}

TEST(NormOfRmse, ByHand) {
  // squares: x 1+1+4+0, y 0+4+4+0, z 4+4+1+9
  EXPECT_NEAR(norm_of_rmse(hand_made_errors()), std::sqrt((6.0 + 8.0 + 18.0) / 4.0), kRounding);
  EXPECT_EQ(absolute_error(hand_made_errors()).rotation.max, 0.0);
}

TEST(FinalDrift, IsRelativeToThePathNotToTheDisplacement) {
  std::vector<PosePair> pairs = straight_line(5, 1.0, kPerfect);
  pairs[3].truth.p.x() = 1.0;
  pairs[4].truth.p.x() = 0.0;  // 0, 1, 2, 1, 0: back where it began after 4 m
  pairs[4].estimate.p = {0.0, 0.06, -0.08};
  EXPECT_EQ(path_length(pairs), 4.0);
  EXPECT_NEAR(final_drift(pairs), 2.5, kRounding);
}

TEST(AngleErrors, SeparateYawFromTilt) {
  const Quaternion none = Quaternion::Identity();
  const Quaternion yaw = quaternion_exp({0.0, 0.0, -5.0 * kDegree});
  const Quaternion tilt = quaternion_exp(Vector3d(0.6, 0.8, 0.0) * 3.0 * kDegree);
  for (const auto& [by_yaw, by_tilt] : {std::pair{yaw, none}, {none, tilt}, {yaw, tilt}}) {
    PosePair pair = straight_line(1, 1.0, kPerfect)[0];
    pair.estimate.q = by_yaw * by_tilt * pair.truth.q;
    EXPECT_NEAR(yaw_error(pair), by_yaw.z() == 0.0 ? 0.0 : -5.0, kRounding);
    EXPECT_NEAR(tilt_error(pair), by_tilt.x() == 0.0 ? 0.0 : 3.0, kRounding);
  }
}

TEST(AngleErrors, RmseFinalAndMax) {
  std::vector<PosePair> pairs = straight_line(3, 1.0, kPerfect);
  const double yaws[] = {1.0, -7.0, -2.0};
  for (std::size_t i = 0; i < 3; ++i) {
    pairs[i].estimate.q = quaternion_exp({0.0, 0.0, yaws[i] * kDegree}) * pairs[i].truth.q;
  }
  const AngleError error = yaw_errors(pairs);
  EXPECT_NEAR(error.rmse, std::sqrt(54.0 / 3.0), kRounding);
  EXPECT_NEAR(error.final, -2.0, kRounding);
  EXPECT_NEAR(error.max, 7.0, kRounding);
}

TEST(AngleErrors, WrapAndIgnoreTheSignOfQuaternions) {
  PosePair pair = straight_line(1, 1.0, kPerfect)[0];
  const Quaternion q = quaternion_exp({0.0, 0.0, 350.0 * kDegree}) * pair.truth.q;
  pair.estimate.q = q;
  EXPECT_NEAR(yaw_error(pair), -10.0, kRounding);
  pair.estimate.q = Quaternion(-q.w(), -q.x(), -q.y(), -q.z());
  EXPECT_NEAR(yaw_error(pair), -10.0, kRounding);
  EXPECT_NEAR(absolute_error({pair}).rotation.max, 10.0, kRounding);
  EXPECT_EQ(wrapped(-180.0), 180.0);
  EXPECT_EQ(wrapped(540.0), 180.0);
  EXPECT_EQ(wrapped(-190.0), 170.0);
}

TEST(PathDistances, AccumulateTheTruth) {
  const std::vector<PosePair> pairs = straight_line(3, 0.5, [](StampedPose* p) { p->p *= 7.0; });
  EXPECT_EQ(path_distances(pairs), (std::vector<double>{0.0, 0.5, 1.0}));
}

}  // namespace
}  // namespace rio::eval

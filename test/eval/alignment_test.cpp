// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "support/random_state.hpp"

namespace rio::eval {
namespace {

/// Random true poses; the estimates equal them.
std::vector<PosePair> perfect_pairs(test::Random* random, int count) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < count; ++i) {
    const Vector3d position = random->normal_vector(5.0);
    const StampedPose pose{std::chrono::milliseconds(10 * i), position, random->rotation()};
    pairs.push_back({pose, pose});
  }
  return pairs;
}

double position_cost(const std::vector<PosePair>& pairs) {
  double cost = 0.0;
  for (const PosePair& pair : pairs) cost += (pair.estimate.p - pair.truth.p).squaredNorm();
  return cost;
}

double angle_between(const Quaternion& a, const Quaternion& b) {
  return quaternion_log(a.conjugate() * b).norm();
}

TEST(AlignSe3, RecoversARandomMotion) {
  test::Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const std::vector<PosePair> perfect = perfect_pairs(&random, 20);
    const Pose T{random.rotation(), random.normal_vector(50.0)};
    std::vector<PosePair> moved = perfect;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i].truth = transformed(T, moved[i].truth);
    const Alignment alignment = align_se3(moved);
    EXPECT_TRUE(alignment.unique);
    // means of positions of 100 m carry 1e-14 m a sample, 20 samples
    EXPECT_LT(angle_between(alignment.transform.rotation, T.rotation), 1e-12);
    EXPECT_LT((alignment.transform.translation - T.translation).norm(), 1e-12);
    for (const PosePair& pair : transformed(alignment.transform, moved)) {
      EXPECT_LT((pair.estimate.p - pair.truth.p).norm(), 1e-12);
      EXPECT_LT(angle_between(pair.estimate.q, pair.truth.q), 1e-12);
    }
  }
}

TEST(AlignSe3, NeverMirrors) {
  // the estimate is the mirror image of the truth: the best orthogonal matrix is diag(1, 1, -1)
  test::Random random(2);
  std::vector<PosePair> pairs = perfect_pairs(&random, 20);
  for (PosePair& pair : pairs) pair.estimate.p.z() = -pair.truth.p.z();
  const Matrix3d R = align_se3(pairs).transform.rotation.toRotationMatrix();
  EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
  EXPECT_GT(position_cost(transformed(align_se3(pairs).transform, pairs)), 1.0);
}

TEST(AlignSe3, PlanarPathsAreUniqueLinesAreNot) {
  std::vector<PosePair> plane;
  for (int i = 0; i < 10; ++i) {
    const StampedPose pose{
        std::chrono::seconds(i), {1.0 * i, 0.1 * i * i, 0.0}, Quaternion::Identity()};
    plane.push_back({pose, pose});
  }
  const Pose T{quaternion_exp({0.3, -0.2, 2.0}), {1.0, 2.0, 3.0}};
  for (PosePair& pair : plane) pair.truth = transformed(T, pair.truth);
  const Alignment of_plane = align_se3(plane);
  EXPECT_TRUE(of_plane.unique);
  EXPECT_LT(angle_between(of_plane.transform.rotation, T.rotation), 1e-12);

  std::vector<PosePair> line = plane;
  for (PosePair& pair : line) {
    pair.estimate.p.y() = 0.0;
    pair.truth.p = T.rotation * pair.estimate.p + T.translation;
  }
  const Alignment of_line = align_se3(line);
  EXPECT_FALSE(of_line.unique);
  EXPECT_LT(position_cost(transformed(of_line.transform, line)), 1e-24);
}

TEST(AlignYaw, RecoversYawAndLeavesTilt) {
  test::Random random(3);
  const std::vector<PosePair> perfect = perfect_pairs(&random, 20);
  for (const double yaw : {-3.1, -1.0, 0.0, 0.4, 2.0, 3.1}) {
    const Quaternion turn = quaternion_exp({0.0, 0.0, yaw});
    const Quaternion tilt = quaternion_exp({0.1, -0.05, 0.0});
    const Vector3d shift(10.0, -20.0, 3.0);
    std::vector<PosePair> pairs = perfect;
    for (PosePair& pair : pairs) {
      pair.truth = transformed({turn, shift}, pair.truth);
      pair.estimate.q = tilt * pair.estimate.q;  // attitudes do not take part in the alignment
    }
    const Alignment alignment = align_yaw(pairs);
    EXPECT_TRUE(alignment.unique);
    EXPECT_LT(angle_between(alignment.transform.rotation, turn), 1e-14);
    EXPECT_LT((alignment.transform.translation - shift).norm(), 1e-12);
    for (const PosePair& pair : transformed(alignment.transform, pairs)) {
      const Quaternion left = pair.estimate.q * pair.truth.q.conjugate();
      EXPECT_LT(angle_between(left, turn * tilt * turn.conjugate()), 1e-12);
    }
  }
}

TEST(AlignYaw, LeavesATiltedPathTilted) {
  test::Random random(4);
  std::vector<PosePair> pairs = perfect_pairs(&random, 20);
  const Pose tilt{quaternion_exp({0.2, 0.1, 0.0}), Vector3d::Zero()};
  for (PosePair& pair : pairs) pair.estimate = transformed(tilt, pair.estimate);
  const Quaternion R = align_yaw(pairs).transform.rotation;
  EXPECT_EQ(R.x(), 0.0);
  EXPECT_EQ(R.y(), 0.0);
  EXPECT_GT(position_cost(transformed(align_yaw(pairs).transform, pairs)), 0.1);
  EXPECT_LT(position_cost(transformed(align_se3(pairs).transform, pairs)), 1e-24);
}

TEST(AlignYaw, IsUndeterminedWithoutHorizontalMotion) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 5; ++i) {
    const StampedPose pose{std::chrono::seconds(i), {1.0, 2.0, 0.5 * i}, Quaternion::Identity()};
    pairs.push_back({pose, pose});
  }
  const Alignment alignment = align_yaw(pairs);
  EXPECT_FALSE(alignment.unique);
  EXPECT_EQ(alignment.transform.rotation.z(), 0.0);
  EXPECT_LT(alignment.transform.translation.norm(), 1e-15);
}

// Closed forms are minima: any small motion of the allowed kind makes the position error larger.
TEST(Alignment, IsOptimalForNoisyPaths) {
  test::Random random(5);
  std::vector<PosePair> pairs = perfect_pairs(&random, 30);
  for (PosePair& pair : pairs) pair.estimate.p += random.normal_vector(0.3);
  const std::vector<PosePair> yaw = transformed(align_yaw(pairs).transform, pairs);
  const std::vector<PosePair> se3 = transformed(align_se3(pairs).transform, pairs);
  EXPECT_LE(position_cost(se3), position_cost(yaw));
  EXPECT_LT(position_cost(yaw), position_cost(pairs));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step : {-1e-3, 1e-3}) {
      const Vector3d d = step * Vector3d::Unit(axis);
      const Pose turn{quaternion_exp(d), Vector3d::Zero()};
      const Pose shift{Quaternion::Identity(), d};
      EXPECT_GT(position_cost(transformed(shift, yaw)), position_cost(yaw));
      EXPECT_GT(position_cost(transformed(shift, se3)), position_cost(se3));
      EXPECT_GT(position_cost(transformed(turn, se3)), position_cost(se3));
      if (axis == 2) {
        EXPECT_GT(position_cost(transformed(turn, yaw)), position_cost(yaw));
      }
    }
  }
}

TEST(AlignOrigin, MakesTheFirstPosesCoincide) {
  test::Random random(6);
  std::vector<PosePair> pairs = perfect_pairs(&random, 4);
  pairs[0].estimate.p = {1.0, -2.0, 3.0};
  pairs[0].estimate.q = quaternion_exp({0.4, 0.5, -0.6});
  const StampedPose second = pairs[1].estimate;
  const Quaternion turn = pairs[0].truth.q * pairs[0].estimate.q.conjugate();
  const Vector3d expected = pairs[0].truth.p + turn * (second.p - pairs[0].estimate.p);
  const std::vector<PosePair> aligned = transformed(align_origin(pairs).transform, pairs);
  EXPECT_LT((aligned[0].estimate.p - aligned[0].truth.p).norm(), 1e-14);
  EXPECT_LT(angle_between(aligned[0].estimate.q, aligned[0].truth.q), 1e-15);
  EXPECT_LT((aligned[1].estimate.p - expected).norm(), 1e-14);
  EXPECT_LT(angle_between(aligned[1].estimate.q, turn * second.q), 1e-15);
  pairs[0].truth.q.coeffs().setConstant(std::nan(""));
  EXPECT_THROW((void)align_origin(pairs), std::runtime_error);
}

TEST(Alignment, KindsByName) {
  test::Random random(7);
  std::vector<PosePair> pairs = perfect_pairs(&random, 4);
  for (PosePair& pair : pairs) {
    pair.truth = transformed({quaternion_exp({0.1, 0.2, 0.3}), {1.0, 0.0, 0.0}}, pair.truth);
  }
  const auto rotation = [&](const char* name) {
    return find_alignment(pairs, *alignment_kind(name)).transform.rotation;
  };
  EXPECT_TRUE(rotation("none").isApprox(Quaternion::Identity()));
  EXPECT_TRUE(rotation("origin").isApprox(align_origin(pairs).transform.rotation));
  EXPECT_TRUE(rotation("yaw").isApprox(align_yaw(pairs).transform.rotation));
  EXPECT_TRUE(rotation("se3").isApprox(align_se3(pairs).transform.rotation));
  EXPECT_FALSE(alignment_kind("sim3").has_value());
}

TEST(Alignment, WithoutPairsIsIdentity) {
  for (const auto kind :
       {AlignmentKind::kNone, AlignmentKind::kOrigin, AlignmentKind::kYaw, AlignmentKind::kSe3}) {
    const Pose T = find_alignment({}, kind).transform;
    EXPECT_TRUE(T.rotation.isApprox(Quaternion::Identity()));
    EXPECT_EQ(T.translation, Vector3d::Zero());
  }
}

}  // namespace
}  // namespace rio::eval

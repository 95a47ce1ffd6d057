// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/frontend.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/random_state.hpp"
#include "support/walk.hpp"

namespace rio {
namespace {

using test::kRoom;
using test::options_with;
using test::Points;
using test::Walk;

TEST(Frontend, PredictedRadarVelocityIsThatOfTheLeverArm) {
  Walk walk(options_with(1000, 7));
  walk.move();
  Estimate& x = walk.estimate();
  x.T_BS.translation = Vector3d(0.5, -0.8, 0.3);
  x.nav.gyro_bias = Vector3d(0.3, -0.2, 0.1);
  walk.observe(DetectionList{});  // no consensus: the prediction alone
  const Vector3d w = x.gyro_B - x.nav.gyro_bias;
  const auto radar = [&x, &w](double t) -> Vector3d {
    return x.nav.p_WB + t * x.nav.v_WB +
           x.nav.q_WB * (test::rotation_of(t * w) * x.T_BS.translation);
  };
  const Vector3d v_W = (radar(1e-5) - radar(-1e-5)) / 2e-5;
  const Vector3d v_S = (x.nav.q_WB * x.T_BS.rotation).conjugate() * v_W;
  // differences of some metres over 2e-5 s
  EXPECT_LT((walk.seen().ego_velocity.v_S - v_S).norm(), 1e-9);
  EXPECT_FALSE(walk.seen().ego_velocity.valid);
}

TEST(Frontend, MovingDetectionsAreNeitherMatchedNorFollowed) {
  Walk walk(options_with(1000, 7));
  walk.step(kRoom);
  walk.move();
  DetectionList scan = walk.scan(kRoom);
  scan.items[2].range_rate += 1.0;
  walk.observe(scan);
  EXPECT_FALSE(walk.seen().is_static(2));
  EXPECT_EQ(walk.seen().ego_velocity.inliers, static_cast<int>(kRoom.size()) - 1);
  for (const Match& m : walk.seen().matches.trails) EXPECT_NE(m.detection, 2U);
  walk.advance();
  EXPECT_EQ(walk.frontend().trails().size(), kRoom.size() - 1);
}

TEST(Frontend, AWithdrawnScanTellsNothing) {
  Walk walk(options_with(1000, 7));
  walk.step(kRoom);
  walk.move();
  walk.observe(walk.scan(kRoom));
  Observations seen = walk.seen();
  EXPECT_EQ(seen.ego_velocity.inliers, static_cast<int>(kRoom.size()));
  EXPECT_EQ(seen.matches.trails.size(), kRoom.size());
  seen.withdraw();
  EXPECT_FALSE(seen.ego_velocity.valid);
  EXPECT_FALSE(seen.is_static(0));
  EXPECT_TRUE(seen.matches.trails.empty());
}

TEST(Frontend, WhatIsNearToAMoverGoesWithIt) {
  Options o = options_with(1000, 7);
  for (const double extent : {0.8, 0.0}) {
    o.frontend.mover_extent = extent;
    Walk walk(o);
    walk.step(kRoom);
    walk.move();
    Points world = kRoom;  // a leg that stands, and what it stands in front of
    world.push_back(kRoom[2] + Vector3d(0.3, 0.4, 0.5));
    world.push_back(kRoom[2] + Vector3d(0.5, 0.5, -0.6));
    DetectionList scan = walk.scan(world);
    scan.items[2].range_rate += 1.0;
    walk.observe(scan);
    const std::size_t leg = kRoom.size();
    EXPECT_TRUE(walk.seen().ego_velocity.outlier[2]);
    EXPECT_TRUE(walk.seen().ego_velocity.inlier[leg]);  // of the consensus it is
    EXPECT_EQ(walk.seen().is_static(leg), extent == 0.0);
    EXPECT_TRUE(walk.seen().is_static(leg + 1));
    walk.advance();
    EXPECT_EQ(walk.frontend().trails().size(), kRoom.size() + (extent == 0.0 ? 1 : 0));
  }
}

TEST(Frontend, WhatIsNearToAMoverMeasuresNoLandmark) {
  Walk walk(options_with(1000, 7));
  walk.step({});
  walk.estimate().landmarks.push_back(LandmarkState{kRoom[1]});
  walk.move();
  Points world = kRoom;
  world.push_back(kRoom[1] + Vector3d(0.4, 0.0, 0.3));  // out of the matching gate
  DetectionList scan = walk.scan(world);
  walk.observe(scan);
  ASSERT_EQ(walk.seen().matches.landmarks.size(), 1U);
  scan.items.back().range_rate -= 1.0;
  walk.observe(scan);
  EXPECT_TRUE(walk.seen().matches.landmarks.empty());
}

TEST(Frontend, MatchesAfterAlignmentWithBothPoses) {
  Walk walk(options_with(1000, 7));
  walk.step(kRoom);
  const DetectionList before = walk.scan(kRoom);
  walk.move();
  const DetectionList now = walk.scan(kRoom);
  walk.observe(now);
  ASSERT_EQ(walk.seen().matches.trails.size(), kRoom.size());
  int shifted = 0;
  for (const Match& m : walk.seen().matches.trails) {
    EXPECT_EQ(m.target, m.detection);
    const Vector3d shift = now.items[m.detection].point_S - before.items[m.detection].point_S;
    shifted += shift.norm() > 0.3 ? 1 : 0;
  }
  EXPECT_GE(shifted, 6);  // the gate alone would not have bridged the motion
  // a wrong current pose, or a wrong past one, breaks it
  const NavState good = walk.estimate().nav;
  walk.estimate().nav.p_WB.x() += 0.5;
  walk.observe(now);
  EXPECT_TRUE(walk.seen().matches.trails.empty());
  walk.estimate().nav = good;
  walk.estimate().clones[0].T_WB.p.y() += 0.5;
  walk.observe(now);
  EXPECT_TRUE(walk.seen().matches.trails.empty());
}

TEST(Frontend, ATrailWithoutItsCloneIsNotMatched) {
  Walk walk(options_with(1000, 7));
  walk.step(kRoom);
  walk.estimate().clones.clear();
  walk.move();
  walk.observe(walk.scan(kRoom));
  EXPECT_TRUE(walk.seen().matches.trails.empty());
}

// One trail at kRoom[0] and one landmark, both within reach of two detections there.
std::vector<Vector3d> compete(const Vector3d& landmark, const Vector3d& a, const Vector3d& b) {
  Walk walk(options_with(1000, 7));
  walk.step(Points{kRoom[0]});
  walk.estimate().landmarks.push_back(LandmarkState{kRoom[0] + landmark});
  walk.move();
  const Points now = {kRoom[0] + a, kRoom[0] + b};
  walk.observe(walk.scan(now));
  std::vector<Vector3d> out(2, Vector3d::Constant(-1.0));  // of the trail, of the landmark
  for (const Match& m : walk.seen().matches.trails) out[0] = now[m.detection] - kRoom[0];
  for (const Match& m : walk.seen().matches.landmarks) out[1] = now[m.detection] - kRoom[0];
  return out;
}

TEST(Frontend, LandmarksAndTrailsCompeteInOnePool) {
  const auto at = [](double x) { return Vector3d(x, 0.0, 0.0); };
  // both would take a; it goes to the trail, which has no other: 0.02 + 0.18 instead of 0.07 + gate
  auto matched = compete(at(-0.05), at(0.02), at(-0.23));
  EXPECT_LT((matched[0] - at(0.02)).norm(), 1e-12);
  EXPECT_LT((matched[1] - at(-0.23)).norm(), 1e-12);
  // and to the landmark when the trail is the one with a choice
  matched = compete(at(0.25), at(0.1), at(-0.2));
  EXPECT_LT((matched[0] - at(-0.2)).norm(), 1e-12);
  EXPECT_LT((matched[1] - at(0.1)).norm(), 1e-12);
}

TEST(Frontend, EveryStaticDetectionHasOneSink) {
  test::Random random(1);
  Walk walk(options_with(3, 5));
  walk.estimate().landmarks.push_back(LandmarkState{kRoom[1]});
  walk.estimate().landmarks.push_back(LandmarkState{kRoom[4]});
  for (int k = 0; k < 100; ++k) {
    Points world;
    for (const Vector3d& p : kRoom) {  // each up to three times, smeared over the gate
      for (std::size_t n = random.index(4); n > 0; --n)
        world.push_back(p + random.normal_vector(0.1));
    }
    walk.move();
    const DetectionList scan = walk.scan(world);
    walk.observe(scan);
    std::vector<int> sinks(scan.items.size(), 0);
    for (const Match& m : walk.seen().matches.landmarks) ++sinks[m.detection];
    walk.advance(random.index(3));
    const auto add = [&](const Detection& d) {
      for (std::size_t i = 0; i < sinks.size(); ++i)
        sinks[i] += scan.items[i].point_S == d.point_S ? 1 : 0;
    };
    for (const Detection& d : walk.promotions().births) add(d);
    const TrailSet& trails = walk.frontend().trails();
    for (std::size_t i = 0; i < trails.size(); ++i) {
      EXPECT_EQ(trails[i].newest().scan + 1, walk.scans());
      add(trails[i].newest().detection);
    }
    for (std::size_t i = 0; i < sinks.size(); ++i)
      EXPECT_EQ(sinks[i], walk.seen().is_static(i) ? 1 : 0);
  }
}

TEST(Frontend, ObservingTwiceGivesTheSame) {
  Walk walk(options_with(1000, 7));
  walk.estimate().landmarks.push_back(LandmarkState{kRoom[3]});
  for (int k = 0; k < 3; ++k) walk.step(kRoom);
  walk.move();
  const DetectionList scan = walk.scan(kRoom);
  walk.observe(scan);
  const Observations first = walk.seen();
  walk.observe(walk.scan(Points(kRoom.begin() + 4, kRoom.end())));
  walk.observe(scan);
  const auto same = [](const Match& a, const Match& b) {
    return a.target == b.target && a.detection == b.detection;
  };
  const Observations& again = walk.seen();
  EXPECT_EQ(again.ego_velocity.inlier, first.ego_velocity.inlier);
  EXPECT_EQ(again.ego_velocity.v_S, first.ego_velocity.v_S);
  EXPECT_EQ(first.matches.landmarks.size(), 1U);
  EXPECT_TRUE(std::equal(again.matches.trails.begin(), again.matches.trails.end(),
                         first.matches.trails.begin(), first.matches.trails.end(), same));
  EXPECT_TRUE(std::equal(again.matches.landmarks.begin(), again.matches.landmarks.end(),
                         first.matches.landmarks.begin(), first.matches.landmarks.end(), same));
  ASSERT_EQ(walk.frontend().trails().size(), kRoom.size() - 1);
  for (std::size_t i = 0; i < kRoom.size() - 1; ++i) {
    EXPECT_EQ(walk.frontend().trails()[i].elements.size(), 3U);
  }
}

TEST(Frontend, SwitchesTurnTrailsAndLandmarksOff) {
  Options none = options_with(2, 7);
  none.update.use_trails = none.update.use_landmarks = false;
  Walk walk(none);
  walk.estimate().landmarks.push_back(LandmarkState{kRoom[0]});
  for (int k = 0; k < 4; ++k) walk.step(kRoom, 20);
  EXPECT_TRUE(walk.seen().matches.landmarks.empty());
  EXPECT_EQ(walk.frontend().trails().size(), 0U);
  EXPECT_EQ(walk.seen().ego_velocity.inliers, static_cast<int>(kRoom.size()));

  Options no_landmarks = options_with(2, 7);
  no_landmarks.update.use_trails = true;
  no_landmarks.update.use_landmarks = false;
  Walk trails_only(no_landmarks);
  trails_only.estimate().landmarks.push_back(LandmarkState{kRoom[0]});
  for (int k = 0; k < 5; ++k) trails_only.step(kRoom, 20);
  EXPECT_TRUE(trails_only.seen().matches.landmarks.empty());
  EXPECT_TRUE(trails_only.promotions().births.empty());
  EXPECT_EQ(trails_only.frontend().trails().size(), kRoom.size());
}

/// Scans of kRoom in which detection 2 recedes by some sigmas more than a static one.
class SlowMover {
 public:
  explicit SlowMover(const Options& options) : walk(options) { walk.step(kRoom, 20); }
  /// True if it is still taken for a part of the world.
  bool scan(double sigmas) {
    walk.move();
    DetectionList scan = walk.scan(kRoom);
    Detection& d = scan.items[2];
    d.range_rate += sigmas * std::sqrt(residual_variance(d, radar_velocity(walk.estimate())));
    walk.observe(scan);
    const bool is_static = walk.seen().is_static(2);
    walk.advance(20);
    return is_static;
  }

  Walk walk;
};

// The sum of n residuals of a static point is within three times the root of n.
TEST(Frontend, SlowMoversShowByResidualsThatAddUp) {
  Options o = options_with(1000, 7);
  for (const double sigmas : {1.5, -1.5}) {
    SlowMover mover(o);
    for (int n = 1; n <= 8; ++n) EXPECT_EQ(mover.scan(sigmas), n <= 4) << n;  // 1.5 n < 3 sqrt(n)
  }
  SlowMover wavering(o);  // each residual in the way of the one before: a static point
  for (int n = 1; n <= 8; ++n) EXPECT_TRUE(wavering.scan(n % 2 == 0 ? 2.0 : -2.0)) << n;
  o.frontend.mover_sigmas = 0.0;
  SlowMover unseen(o);
  for (int n = 1; n <= 8; ++n) EXPECT_TRUE(unseen.scan(1.5)) << n;
}

TEST(Frontend, AMoverIsFollowedAndNotPromoted) {
  Options o = options_with(5, 7);
  SlowMover mover(o);
  for (int n = 1; n <= 5; ++n) (void)mover.scan(1.5);
  EXPECT_EQ(mover.walk.promotions().births.size(), kRoom.size() - 1);
  ASSERT_EQ(mover.walk.frontend().trails().size(), 1U);
  EXPECT_EQ(mover.walk.frontend().trails()[0].matches, 5);
  (void)mover.scan(1.5);
  EXPECT_TRUE(mover.walk.promotions().births.empty());
}

// Of two detections within the gate of one landmark neither is clearly its match, and neither is a
// new point.
TEST(Frontend, WhatIsNearALandmarkBeginsNoTrail) {
  for (const bool known : {false, true}) {
    Options o = options_with(1000, 7);
    o.frontend.matching = Matching::kMahalanobis;
    Walk walk(o);
    if (known) {
      LandmarkState landmark{kRoom[1]};
      landmark.covariance_S = 0.01 * Matrix3d::Identity();
      walk.estimate().landmarks.push_back(landmark);
    }
    Points world = kRoom;
    world.push_back(kRoom[1] + Vector3d(0.02, 0.0, 0.0));
    walk.step(world);
    EXPECT_TRUE(walk.seen().matches.landmarks.empty());
    EXPECT_EQ(walk.frontend().trails().size(), known ? kRoom.size() - 1 : kRoom.size() + 1);
  }
}

}  // namespace
}  // namespace rio

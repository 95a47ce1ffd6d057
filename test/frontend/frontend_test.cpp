// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/frontend.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "frontend/walk.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

TEST(Frontend, PredictedRadarVelocityIsThatOfTheLeverArm) {
  Walk walk(options_with(1000, 7));
  walk.move();
  Estimate& x = walk.estimate();
  x.T_BS.translation = Vector3d(0.5, -0.8, 0.3);
  x.nav.gyro_bias = Vector3d(0.3, -0.2, 0.1);
  walk.observe(DetectionList{});  // no consensus: the prediction alone
  const Vector3d w = x.gyro_B - x.nav.gyro_bias;
  const auto radar = [&x, &w](double t) -> Vector3d {
    return x.nav.p_WB + t * x.nav.v_WB + x.nav.q_WB * (rotation_of(t * w) * x.T_BS.translation);
  };
  const Vector3d v_W = (radar(1e-5) - radar(-1e-5)) / 2e-5;
  const Vector3d v_S = (x.nav.q_WB * x.T_BS.rotation).conjugate() * v_W;
  // differences of some metres over 2e-5 s
  EXPECT_LT((walk.seen().ego_velocity.v_S - v_S).norm(), 1e-9);
  EXPECT_FALSE(walk.seen().ego_velocity.valid);
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
    for (const Match& m : walk.seen().matches.trails) EXPECT_NE(m.detection, 2U);
    EXPECT_TRUE(walk.seen().ego_velocity.inlier[leg]);  // of the consensus it is
    EXPECT_EQ(walk.seen().is_static(leg), extent == 0.0);
    EXPECT_TRUE(walk.seen().is_static(leg + 1));
    walk.advance();
    EXPECT_EQ(walk.frontend().trails().size(), kRoom.size() + (extent == 0.0 ? 1 : 0));
  }
}

TEST(Frontend, EveryStaticDetectionHasOneSink) {
  Random random(1);
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
  const Observations& again = walk.seen();
  EXPECT_EQ(again.ego_velocity.inlier, first.ego_velocity.inlier);
  EXPECT_EQ(again.ego_velocity.v_S, first.ego_velocity.v_S);
  EXPECT_EQ(first.matches.landmarks.size(), 1U);
  EXPECT_TRUE(std::ranges::equal(again.matches.trails, first.matches.trails));
  EXPECT_TRUE(std::ranges::equal(again.matches.landmarks, first.matches.landmarks));
  ASSERT_EQ(walk.frontend().trails().size(), kRoom.size() - 1);
  for (std::size_t i = 0; i < kRoom.size() - 1; ++i) {
    EXPECT_EQ(walk.frontend().trails()[i].elements.size(), 3U);
  }
}

TEST(Frontend, SwitchesTurnTrailsAndLandmarksOff) {
  for (const bool trails : {false, true}) {
    Options o = options_with(2, 7);
    o.update.use_trails = trails;
    o.update.use_landmarks = false;
    Walk walk(o);
    walk.estimate().landmarks.push_back(LandmarkState{kRoom[0]});
    for (int k = 0; k < 5; ++k) walk.step(kRoom, 20);
    EXPECT_TRUE(walk.seen().matches.landmarks.empty());
    EXPECT_TRUE(walk.promotions().births.empty());
    EXPECT_EQ(walk.frontend().trails().size(), trails ? kRoom.size() : 0U);
    EXPECT_EQ(walk.seen().ego_velocity.inliers, static_cast<int>(kRoom.size()));
  }
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
  const auto static_scans = [&o](double sigmas, double next_sigmas) {
    SlowMover mover(o);
    int count = 0;
    for (int n = 1; n <= 8; ++n) count += mover.scan(n % 2 == 1 ? sigmas : next_sigmas) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(static_scans(1.45, 1.45), 4);  // 1.45 n < 3 sqrt(n)
  EXPECT_EQ(static_scans(-1.45, -1.45), 4);
  EXPECT_EQ(static_scans(-2.0, 2.0), 8);  // each residual in the way of the one before
  o.frontend.mover_sigmas = 0.0;
  EXPECT_EQ(static_scans(1.45, 1.45), 8);
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
}  // namespace rio::test

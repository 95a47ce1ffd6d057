// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/trails.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "frontend/walk.hpp"

namespace rio::test {
namespace {

// By matches that the gate alone would not bridge, without the pose of this scan or of the one
// before.
TEST(Trails, TrailsAreBornExtendedAndBounded) {
  constexpr int kMaxLength = 4;
  Walk walk(options_with(1000, kMaxLength));
  DetectionList before;
  for (int k = 0; k < 8; ++k) {
    walk.step(kRoom);
    const DetectionList now = walk.scan(kRoom);
    int moved = 0;
    for (std::size_t i = 0; i < before.items.size(); ++i) {
      moved += (now.items[i].point_S - before.items[i].point_S).norm() > 0.3 ? 1 : 0;
    }
    EXPECT_GE(moved, k == 0 ? 0 : 6);
    before = now;
    const TrailSet& trails = walk.frontend().trails();
    ASSERT_EQ(trails.size(), kRoom.size()) << k;
    EXPECT_EQ(walk.seen().matches.trails.size(), k == 0 ? 0U : kRoom.size());
    for (std::size_t i = 0; i < trails.size(); ++i) {
      const Trail& trail = trails[i];
      EXPECT_EQ(trail.matches, k);
      ASSERT_EQ(trail.elements.size(), static_cast<std::size_t>(std::min(k + 1, kMaxLength)));
      for (std::size_t e = 0; e < trail.elements.size(); ++e) {  // consecutive, newest last
        EXPECT_EQ(trail.elements[e].scan + trail.elements.size() - 1 - e, static_cast<ScanId>(k));
      }
    }
  }
  walk.frontend().reset();
  EXPECT_EQ(walk.frontend().trails().size(), 0U);
}

TEST(Trails, TrailDiesAtItsFirstMissAndIsBornAgain) {
  Walk walk(options_with(1000, 7));
  for (int k = 0; k < 3; ++k) walk.step(kRoom);
  const Points without_first(kRoom.begin() + 1, kRoom.end());
  walk.step(without_first);
  EXPECT_EQ(walk.frontend().trails().size(), kRoom.size() - 1);
  walk.step(kRoom);
  const TrailSet& trails = walk.frontend().trails();
  ASSERT_EQ(trails.size(), kRoom.size());
  for (std::size_t i = 0; i < trails.size(); ++i) {
    const bool young = i + 1 == trails.size();
    EXPECT_EQ(trails[i].matches, young ? 0 : 4) << i;
    EXPECT_EQ(trails[i].elements.size(), young ? 1U : 5U) << i;
  }
}

TEST(Trails, PromotesAfterConsecutiveMatchesWithTheNewestDetection) {
  constexpr int kAfter = 3;
  Walk walk(options_with(kAfter, 7));
  for (int k = 0; k < kAfter; ++k) {
    walk.step(kRoom, 20);
    EXPECT_TRUE(walk.promotions().births.empty()) << k;
  }
  walk.step(kRoom, 20);
  ASSERT_EQ(walk.promotions().births.size(), kRoom.size());
  const DetectionList newest = walk.scan(kRoom);
  for (std::size_t i = 0; i < kRoom.size(); ++i) {
    EXPECT_EQ(walk.promotions().births[i].point_S, newest.items[i].point_S);
  }
  EXPECT_EQ(walk.frontend().trails().size(), 0U);  // the detections went into the landmarks
}

TEST(Trails, TrailWithoutRoomGoesOnAsATrail) {
  constexpr int kAfter = 2;
  Walk walk(options_with(kAfter, 3));
  for (int k = 0; k < kAfter; ++k) walk.step(kRoom, 20);
  walk.step(kRoom, 0);
  EXPECT_TRUE(walk.promotions().births.empty());
  EXPECT_EQ(walk.frontend().trails().size(), kRoom.size());
  walk.step(kRoom, 3);
  EXPECT_EQ(walk.promotions().births.size(), 3U);
  const TrailSet& trails = walk.frontend().trails();
  ASSERT_EQ(trails.size(), kRoom.size() - 3);
  for (std::size_t i = 0; i < trails.size(); ++i) EXPECT_EQ(trails[i].matches, kAfter + 1);
}

}  // namespace
}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/association.hpp"

#include <gtest/gtest.h>

#include "frontend/matching_test.hpp"
#include "rio/core/so3.hpp"

namespace rio {
namespace {

class AssociationTest : public test::MatchingTest {
 protected:
  AssociationTest() {
    options_.matching = Matching::kMahalanobis;
    options_.match_probability = 0.99;
  }
};

// An error of the pose moves azimuth and elevation together.
TEST_F(AssociationTest, CorrelatedErrorsOfTheAnglesHaveASign) {
  for (const double sign : {1.0, -1.0}) {
    clear();
    know({4.0, 0.0, 0.0}, 0.01);
    Matrix3d& P = estimate_.landmarks[0].covariance_S;
    P(1, 1) = P(2, 2) = 0.36;
    P(1, 2) = P(2, 1) = 0.34;
    see(4.0 * Vector3d(4.0, 0.9, sign * 0.9).normalized());
    EXPECT_EQ(matched(), sign > 0.0 ? 1U : 0U);
  }
}

TEST_F(AssociationTest, OnlyTheCoreOfTheGateCountsOnceTheRadarHasMoved) {
  know({4.0, 0.0, 0.0}, 0.01);
  see({4.07, 0.0, 0.0});  // 2.2 sigma: within 0.95 of three degrees, beyond 0.6 of them
  estimate_.landmarks[0].distance_seen = 10.0;
  estimate_.distance_travelled = 10.0 + 0.9 * kSameEcho;
  EXPECT_EQ(matched(), 1U);
  estimate_.distance_travelled = 10.0 + 1.1 * kSameEcho;
  EXPECT_EQ(matched(), 0U);
  EXPECT_TRUE(match().near_landmark[0]);  // and yet no new point
  scan_.items.clear();
  see({4.04, 0.0, 0.0});  // 1.3 sigma
  EXPECT_EQ(matched(), 1U);
  options_.matching = Matching::kProbability;  // knows no core
  scan_.items.clear();
  see({4.07, 0.0, 0.0});
  EXPECT_EQ(matched(), 1U);
}

// Wider for a vaguer landmark, until other echoes are in it, too: with noise of 3, 12 and 24 cm at
// 4 m there are 17 cells where the prediction is 20 cm off, 200 at 50 cm.
TEST_F(AssociationTest, UncertaintyOfTheLandmarkWidensTheGateUpToAHundredCells) {
  struct Row {
    double range, sigma;
    bool matched;
  };
  for (const Row& row : {Row{4.3, 0.01, false}, Row{4.3, 0.2, true}, Row{4.0, 0.5, false}}) {
    clear();
    know({4.0, 0.0, 0.0}, row.sigma);
    see({row.range, 0.0, 0.0});
    EXPECT_EQ(matched(), row.matched ? 1U : 0U) << row.range << " " << row.sigma;
    EXPECT_EQ(match().near_landmark[0], row.matched);  // else a new trail may begin
  }
}

TEST_F(AssociationTest, AVagueLandmarkDoesNotWinByItsVagueness) {
  options_.match_margin = 0.0;
  see({4.05, 0.0, 0.0});
  know({4.0, 0.0, 0.0}, 0.3);    // d2 is smallest here
  know({4.0, 0.05, 0.0}, 0.02);  // but this is likelier
  const AssociationResult result = match();
  ASSERT_EQ(result.landmarks.size(), 1U);
  EXPECT_EQ(result.landmarks[0].target, 1U);
}

TEST_F(AssociationTest, AmbiguousPairsAreLeftOut) {
  know({4.0, 0.0, 0.0}, 0.02);
  see({4.0, 0.05, 0.0});
  EXPECT_EQ(matched(), 1U);
  see({4.0, -0.06, 0.0});  // as near: either might be it
  EXPECT_EQ(matched(), 0U);
  options_.match_margin = 0.0;
  EXPECT_EQ(matched(), 1U);
  // nothing new begins beside a landmark
  EXPECT_TRUE(match().near_landmark[0]);
  EXPECT_TRUE(match().near_landmark[1]);
}

TEST_F(AssociationTest, TwoLandmarksForOneDetectionAreAmbiguousToo) {
  know({4.0, 0.05, 0.0}, 0.02);
  know({4.0, -0.06, 0.0}, 0.02);
  see({4.0, 0.0, 0.0});
  EXPECT_EQ(matched(), 0U);
  estimate_.landmarks[1].p_W.y() = -0.35;
  EXPECT_EQ(matched(), 1U);
}

TEST_F(AssociationTest, UnusableDetectionsAreNotMatched) {
  know({4.0, 0.0, 0.0}, 0.02);
  see({4.0, 0.0, 0.0});
  usable_[0] = false;
  EXPECT_EQ(matched(), 0U);
  EXPECT_FALSE(match().near_landmark[0]);
}

TEST_F(AssociationTest, TrailsMoveWithTheRadarAndNeedNoMargin) {
  // seen at 4 m ahead from the origin; then the radar went 0.5 m forward and turned left by 0.2 rad
  follow({4.0, 0.0, 0.0});
  estimate_.nav.p_WB = {0.5, 0.0, 0.0};
  estimate_.nav.q_WB = quaternion_exp({0.0, 0.0, 0.2});
  see(quaternion_exp({0.0, 0.0, -0.2}) * Vector3d(3.5, 0.05, 0.0));
  see(quaternion_exp({0.0, 0.0, -0.2}) * Vector3d(3.5, -0.06, 0.0));
  const AssociationResult result = match();
  ASSERT_EQ(result.trails.size(), 1U);
  EXPECT_EQ(result.trails[0].detection, 0U);
  EXPECT_FALSE(result.near_landmark[0]);
  estimate_.clones[0].scan = 8;  // its pose has left the window
  EXPECT_TRUE(match().trails.empty());
}

}  // namespace
}  // namespace rio

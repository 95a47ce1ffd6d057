// SPDX-License-Identifier: BSD-3-Clause
// Matching by the density of a detection's own noise at the known point (Xu et al., eq. 13-14).
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "frontend/matching_test.hpp"
#include "rio/core/chi2.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

class ProbabilityMatching : public test::MatchingTest {
 protected:
  ProbabilityMatching() {
    options_.matching = Matching::kProbability;
    options_.match_probability = 0.9973;  // three sigma
  }
  /// The landmark of each detection, or -1.
  std::vector<int> landmark_of() {
    std::vector<int> of(scan_.items.size(), -1);
    for (const Match& m : match().landmarks) of[m.detection] = static_cast<int>(m.target);
    return of;
  }
  /// Off a detection on boresight by so many of its sigmas of range, azimuth and elevation.
  static Vector3d off_by(double range, const Vector3d& sigmas) {
    const double y = kSigmaAzimuth * sigmas[1];
    const double z = kSigmaElevation * sigmas[2];
    return (range + kSigmaRange * sigmas[0]) * Vector3d(std::sqrt(1.0 - y * y - z * z), y, z);
  }
};

// Aside as well as along: what is far may be farther aside. A landmark that is known exactly has
// the same gate where its uncertainty counts.
TEST_F(ProbabilityMatching, TheCheckIsThreeSigmaOfThreeDegreesOfFreedom) {
  EXPECT_NEAR(chi2_quantile(options_.match_probability, 3.0), 14.16, 0.01);
  for (const auto& [matching, range] : {std::pair{Matching::kProbability, 2.0},
                                        {Matching::kProbability, 8.0},
                                        {Matching::kMahalanobis, 2.0},
                                        {Matching::kMahalanobis, 8.0}}) {
    options_.matching = matching;
    // the same distance made of one, two and three parts
    for (const Vector3d& parts :
         {Vector3d(1.0, 0.0, 0.0), Vector3d(0.0, 1.0, 0.0), Vector3d(0.0, 0.0, 1.0),
          Vector3d(0.5, 0.5, 0.0), Vector3d(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)}) {
      for (const auto& [d2, expected] : {std::pair{14.1, 0}, {14.2, -1}}) {
        clear();
        see({range, 0.0, 0.0});
        know(off_by(range, (d2 * parts).cwiseSqrt()), 0.0);
        EXPECT_EQ(landmark_of()[0], expected) << range << " m, " << d2 << ": " << parts.transpose();
        EXPECT_EQ(match().near_landmark[0], expected == 0);
      }
    }
  }
}

TEST_F(ProbabilityMatching, TheNoiseOfTheLandmarkDoesNotCount) {
  know(off_by(4.0, {4.5, 0.0, 0.0}), 0.3);
  see({4.0, 0.0, 0.0});
  EXPECT_EQ(landmark_of()[0], -1);
  options_.matching = Matching::kMahalanobis;
  EXPECT_EQ(landmark_of()[0], 0);
}

TEST_F(ProbabilityMatching, TheOwnSigmasOfADetectionCount) {
  know({4.0, 0.0, 0.0});
  scan_.items.push_back(
      make_detection({.point_S = {4.2, 0.0, 0.0}, .sigma_range = 0.1}, radar_));  // 2 sigma
  EXPECT_EQ(landmark_of()[0], 0);
  scan_.items[0].sigma_range = kSigmaRange;
  EXPECT_EQ(landmark_of()[0], -1);
}

// Fig. 3 of the paper: aside by 1.7 sigma against behind by 5 sigma, which is half as far.
TEST_F(ProbabilityMatching, TheLikelierPointIsNotTheNearerOne) {
  see({6.0, 0.0, 0.0});
  know(off_by(6.0, {0.0, 1.7, 0.0}));
  know({6.15, 0.0, 0.0});
  EXPECT_EQ(landmark_of()[0], 0);
  options_.matching = Matching::kEuclidean;
  EXPECT_EQ(landmark_of()[0], 1);
}

TEST_F(ProbabilityMatching, PairsAreOptimalNotGreedy) {
  // the second detection lies between the landmarks, nearest to the first one, which is all that
  // the first detection could have
  know({4.00, 0.0, 0.0});
  know({4.08, 0.0, 0.0});
  see({3.92, 0.0, 0.0});  // 2.7 and 5.3 sigma
  see({4.03, 0.0, 0.0});  // 1.0 and 1.7 sigma
  EXPECT_EQ(landmark_of(), (std::vector<int>{0, 1}));
  estimate_.landmarks.resize(1);  // one landmark goes to the likelier one of two
  EXPECT_EQ(landmark_of(), (std::vector<int>{-1, 0}));
}

TEST_F(ProbabilityMatching, WithoutAMarginButWhatIsNearIsNoNewPoint) {
  know({4.00, 0.0, 0.0});
  know({4.07, 0.0, 0.0});
  see({4.04, 0.0, 0.0});  // nearly as likely from either
  EXPECT_EQ(landmark_of()[0], 1);
  EXPECT_TRUE(match().near_landmark[0]);
}

TEST_F(ProbabilityMatching, TrailsTakePartOnTheSameTerms) {
  follow(off_by(6.0, {0.0, 2.0, 0.0}));
  see({6.0, 0.0, 0.0});
  for (const auto& [range, likelier] : {std::pair{6.075, "trail"}, {6.04, "landmark"}}) {
    SCOPED_TRACE(likelier);
    estimate_.landmarks.clear();
    know({range, 0.0, 0.0});
    const AssociationResult result = match();
    EXPECT_EQ(result.trails.size(), range > 6.05 ? 1U : 0U);
    EXPECT_EQ(result.landmarks.size(), range > 6.05 ? 0U : 1U);
  }
}

// A retired landmark is one that a window keeps for its factors alone.
TEST_F(ProbabilityMatching, ARetiredLandmarkIsNotMatched) {
  see({4.0, 0.0, 0.0});
  know({4.0, 0.0, 0.0});
  know({4.05, 0.0, 0.0});
  EXPECT_EQ(landmark_of()[0], 0);
  estimate_.landmarks[0].retired = true;
  EXPECT_EQ(landmark_of()[0], 1);
}

/// Scenes of a detection and five landmarks around it. What is chosen is the landmark with the
/// highest density of N(p, Sigma_m), computed as written in the paper, eq. 13; near ties are left
/// out. The distance here is polar, equal to the first order: with fine angles the bend over three
/// sigma, 8 m (0.018 rad)^2 / 2, is a twentieth of sigma_range. With those of the preset, at 8 m
/// three sigma of elevation are 0.06 m of range, two sigmas: what is chosen is then another
/// landmark now and then (data/presets.md).
TEST_F(ProbabilityMatching, AgreesWithTheCartesianDensityUpToTheBend) {
  Options published;
  ASSERT_TRUE(preset("published-uncertainty", &published));
  radar_.sigma_azimuth = 0.003;
  radar_.sigma_elevation = 0.006;
  for (const bool fine : {true, false}) {
    SCOPED_TRACE(fine ? "fine angles" : "angles of the preset");
    if (!fine) radar_ = published.radar;
    test::Random random(31);
    int compared = 0;
    int chosen_aside = 0;  // the likeliest is not the nearest in metres
    int other = 0;         // another one was chosen than by eq. 13
    for (int scene = 0; scene < 500; ++scene) {
      clear();
      see({random.uniform(2.0, 8.0), random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0)});
      const Detection& d = scan_.items[0];
      const Matrix3d covariance = point_covariance(d);
      const Matrix3d root = covariance.llt().matrixL();
      std::vector<double> densities;  // without the factor that all of them have
      std::vector<double> distances;
      for (int i = 0; i < 5; ++i) {
        const Vector3d offset = root * random.normal_vector(1.2);
        know(d.point_S + offset);
        densities.push_back(std::exp(-0.5 * offset.dot(covariance.inverse() * offset)));
        distances.push_back(offset.norm());
      }
      const auto best = std::max_element(densities.begin(), densities.end()) - densities.begin();
      const auto nearest = std::min_element(distances.begin(), distances.end()) - distances.begin();
      std::sort(densities.rbegin(), densities.rend());
      if (densities[1] > 0.8 * densities[0]) continue;
      ++compared;
      chosen_aside += nearest != best ? 1 : 0;
      other += landmark_of()[0] != static_cast<int>(best) ? 1 : 0;
    }
    EXPECT_GT(compared, 300);
    EXPECT_GT(chosen_aside, 50);
    EXPECT_EQ(other > 0, !fine);
    EXPECT_LT(other, compared / 10);
  }
}

}  // namespace
}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The factor of looks whose correlation is known. In scan_rows_test.cpp: what it multiplies.
#include "rio/update/look_correlation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rio/sim/random.hpp"

namespace rio {
namespace {

constexpr double kShare = 0.98;  // b of (E1)

/// Landmarks seen for that many looks each, a share of the variance common to all of their looks.
/// @return mean factor, without the first 10,000 looks
double mean_factor(int looks, double common) {
  constexpr int kLooks = 200'000;
  constexpr int kFirst = 10'000;
  sim::Random random(3, 1);
  const auto normal2 = [&random] { return Eigen::Vector2d(random.normal(), random.normal()); };
  LookCorrelation correlation;
  double sum = 0.0;
  int count = 0;
  while (count < kLooks) {
    LandmarkState::Looks of_landmark;
    const Eigen::Vector2d lasting = std::sqrt(common) * normal2();
    for (int k = 0; k < looks; ++k, ++count) {
      correlation.add(lasting + std::sqrt(1.0 - common) * normal2(), &of_landmark);
      if (count >= kFirst) sum += correlation.factor();
    }
  }
  return sum / (count - kFirst);
}

/// (E1) with numerator and denominator averaged over the looks 1 to n.
double expected_factor(int looks, double common) {
  double numerator = 0.0;
  double denominator = 0.0;
  double weights = 0.0;
  double squares = 0.0;
  for (int k = 0; k < looks; ++k) {
    weights = kShare * weights + 1.0;
    squares = kShare * kShare * squares + 1.0;
    numerator += common * weights * weights + (1.0 - common) * squares;
    denominator += squares;
  }
  return numerator / denominator;
}

TEST(LookCorrelation, StartsWithThatOfRoughRecordings) {
  EXPECT_EQ(LookCorrelation{}.factor(), 10.0);
}

TEST(LookCorrelation, IsNoneOfIndependentErrors) {
  for (const int looks : {1, 10, 1000}) {
    const double factor = mean_factor(looks, 0.0);
    EXPECT_GE(factor, 1.0);
    EXPECT_LT(factor, 1.15) << looks;  // the mean of what scatters and is at least 1
  }
}

TEST(LookCorrelation, OfALastingErrorGrowsWithTheLooks) {
  for (const double common : {0.3, 1.0}) {
    for (const int looks : {1, 10, 20}) {
      const double expected = expected_factor(looks, common);
      EXPECT_NEAR(mean_factor(looks, common), expected, 0.06 * expected) << looks << " " << common;
      // 1 + c (n - 1) of the last look; two thirds of it on the mean over the looks
      EXPECT_NEAR(expected - 1.0, 2.0 / 3.0 * common * (looks - 1), 0.15 * (expected - 1.0));
    }
  }
}

// Of one look: the sum of the landmark alone.
TEST(LookCorrelation, SumsTheInnovationsOfALandmark) {
  LookCorrelation correlation;
  LandmarkState::Looks looks;
  correlation.add({3.0, 0.0}, &looks);
  correlation.add({-1.0, 2.0}, &looks);
  EXPECT_LT((looks.innovation - Eigen::Vector2d(3.0 * kShare - 1.0, 2.0)).norm(), 1e-12);
  EXPECT_LT((looks.squares - Eigen::Vector2d(9.0 * kShare * kShare + 1.0, 4.0)).norm(), 1e-12);
}

// (E3): a landmark 3 m east, 4 m north and 2 m above.
TEST(LandmarkWalk, OfTheHeightGrowsWithTheHorizontalDistance) {
  LandmarkState landmark;
  landmark.p_W = Vector3d(4.0, 6.0, 3.0);
  landmark.looks.elevation_walk = 1e-4;
  const Vector3d p_WB(1.0, 2.0, 1.0);
  const Vector3d expected = 1.5 * Vector3d(4e-4, 4e-4, 4e-4 + 1e-4 * 25.0);
  EXPECT_LT((landmark_walk(landmark, p_WB, 0.02, 1.5) - expected).norm(), 1e-15);
  EXPECT_TRUE(landmark_walk(landmark, p_WB, 0.0, 1.5).isZero(0.0));
}

// (E3) is what is left on a short way of a Gauss-Markov error of the share of the variance that
// lasts: all of it while f is 10, as before the first look, none once f is below 2.
TEST(LandmarkWalk, IsTheWalkOfAGaussMarkovErrorOnAShortWay) {
  constexpr double kSigma = 0.04;
  constexpr double kLength = 20.0;
  constexpr double kStep = 0.05;
  LookCorrelation looks;
  sim::Random random(3);
  const double keep = std::exp(-kStep / kLength);
  double error = random.normal() * kSigma;
  double squares = 0.0;
  constexpr int kSteps = 40000;
  for (int i = 0; i < kSteps; ++i) {
    const double next = keep * error + kSigma * std::sqrt(1.0 - keep * keep) * random.normal();
    squares += (next - error) * (next - error);
    error = next;
  }
  EXPECT_NEAR(looks.elevation_walk(kSigma) * kStep / (squares / kSteps), 1.0, 0.03);
  LandmarkState::Looks sum;
  for (int i = 0; i < 20000; ++i) {
    looks.add({random.normal(), random.normal()}, &sum);
  }
  EXPECT_LT(looks.factor(), 2.0);
  EXPECT_EQ(looks.elevation_walk(kSigma), 0.0);
  for (int i = 0; i < 20000; ++i) looks.add({1.0, random.normal()}, &sum);
  EXPECT_GT(looks.factor(), 10.0);
  EXPECT_EQ(looks.elevation_walk(kSigma), 0.0) << "by azimuths that last";
}

}  // namespace
}  // namespace rio

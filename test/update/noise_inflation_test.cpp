// SPDX-License-Identifier: BSD-3-Clause
// What noise is multiplied by: repetition, doubt about matches, looks whose errors are correlated.
// In scan_rows_test.cpp: what the factors multiply.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "rio/sim/random.hpp"
#include "rio/update/look_correlation.hpp"
#include "rio/update/noise_inflation.hpp"
#include "support/random_state.hpp"
#include "support/symmetric.hpp"

namespace rio {
namespace {

// What n repetitive errors tell of a constant is 1^T C^-1 1 of their covariance C.
TEST(NoiseInflation, RepetitionIsTheInformationOfAnAutocorrelatedSeries) {
  constexpr int kN = 2000;
  for (const double distance : {0.0, 0.005, 0.02, 0.1}) {
    const double rho = 0.98 * std::exp(-distance / 0.02);
    Eigen::MatrixXd C(kN, kN);
    for (int i = 0; i < kN; ++i) {
      for (int j = 0; j < kN; ++j) C(i, j) = std::pow(rho, std::abs(i - j));
    }
    const double information = test::solve(C, Eigen::VectorXd::Ones(kN)).sum();
    // the first value is new: of a correlation length of 50 it adds 1 in 20
    EXPECT_NEAR(kN / repetition_factor(distance, 0.02) / information, 1.0, 0.06) << distance;
  }
}

TEST(NoiseInflation, WhatIsNewCountsInFull) {
  EXPECT_EQ(repetition_factor(0.0, 0.0), 1.0);
  EXPECT_NEAR(repetition_factor(10.0, 0.02), 1.0, 1e-12);
  EXPECT_LT(repetition_factor(0.02, 0.02), repetition_factor(0.01, 0.02));
  EXPECT_EQ(mismatch_factor(1.0), 1.0);
}

// A scalar with many measurements of which a share p is right, and the others have residuals as
// large that tell nothing: the variance of a filter that knows p is its mean square error.
TEST(NoiseInflation, MismatchFactorMakesTheVarianceHonest) {
  constexpr int kRuns = 2000;
  constexpr int kMatches = 1000;
  constexpr double kPrior = 0.1;  // R = 1
  test::Random random(3);
  const auto nees = [&](double p, double factor) {
    double sum = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      const double truth = random.normal(std::sqrt(kPrior));
      double x = 0.0;
      double P = kPrior;
      for (int i = 0; i < kMatches; ++i) {
        const double noise = random.normal();
        const double K = P / (P + factor);
        const double residual = random.uniform(0.0, 1.0) < p ? truth - x + noise : noise;
        x += K * residual;
        P -= K * P;
      }
      sum += (x - truth) * (x - truth) / P;
    }
    return sum / kRuns;
  };
  // 2000 runs scatter by 3 %; what is left of the prior adds a little
  for (const double p : {1.0, 0.85, 0.7}) EXPECT_NEAR(nees(p, mismatch_factor(p)), 1.0, 0.12) << p;
  EXPECT_GT(nees(0.7, 1.0), 2.0);
}

// Reflectors everywhere around the landmark, along one axis: of the detections of neighbours those
// are matched whose direction fits as well as that of a right match.
TEST(NoiseInflation, ADopplerOfAMismatchIsThatOfTheNeighbour) {
  constexpr int kMatches = 200'000;
  constexpr double kAngle = 0.05;    // sigma of the direction [rad]
  constexpr double kSpeed = 1.2;     // across the line of sight [m/s]
  constexpr double kDoppler = 0.02;  // [m/s]
  test::Random random(5);
  for (const double right : {1.0, 0.8, 0.68}) {
    double sum = 0.0;
    for (int i = 0; i < kMatches; ++i) {
      double direction = 0.0;  // of the reflector, from the landmark's
      if (random.uniform(0.0, 1.0) >= right) {
        double measured = 0.0;
        do {
          direction = random.uniform(-8.0 * kAngle, 8.0 * kAngle);
          measured = (direction + random.normal(kAngle)) / kAngle;
        } while (random.uniform(0.0, 1.0) > std::exp(-0.5 * measured * measured));
      }
      const double residual = random.normal(kDoppler) + direction * kSpeed;
      sum += residual * residual;
    }
    const double across = kAngle * kAngle * kSpeed * kSpeed;
    const double variance = kDoppler * kDoppler + mismatch_variance(right, across);
    EXPECT_NEAR(sum / kMatches / variance, 1.0, 0.02) << right;
  }
}

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

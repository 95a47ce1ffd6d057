// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/noise_inflation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>

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

}  // namespace
}  // namespace rio

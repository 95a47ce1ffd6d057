// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/noise_inflation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>

#include "support/random_state.hpp"

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
    const double information =
        Eigen::VectorXd::Ones(kN).dot(C.llt().solve(Eigen::VectorXd::Ones(kN)));
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

/// Of many measurements of a constant with S = 1: those of movers are even within the gate, weights
/// belong to the residuals. M-estimation (Huber, 1964): with score w r the estimate has the
/// variance E[w^2 r^2] / s^2, s the sensitivity of the mean score, where a filter claims 1 / E[w].
struct Weighted {
  double nees = 0.0;         ///< variance over that claimed
  double information = 0.0;  ///< 1 / variance
};
Weighted weighted(double share, double speed, const std::function<double(double nis)>& weight) {
  constexpr double kGate = 2.576;
  constexpr int kSteps = 4000;
  double claimed = 0.0;
  double square = 0.0;
  double sensitivity = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = kGate * (2.0 * (i + 0.5) / kSteps - 1.0);
    const double statics = (1.0 - share) * std::exp(-0.5 * r * r) / std::sqrt(2.0 * M_PI);
    const double both = statics + share / (2.0 * speed);
    const double w = weight(r * r);
    claimed += w * both;
    square += w * w * r * r * both;
    sensitivity += w * r * r * statics;
  }
  const double dr = 2.0 * kGate / kSteps;
  return {claimed * square / (sensitivity * sensitivity), dr * sensitivity * sensitivity / square};
}

TEST(NoiseInflation, MoverFactorIsMoreHonestAndLosesNothing) {
  for (const double speed : {7.5, 30.0}) {  // in sigmas of the residual
    double before = 1.0;
    for (const double share : {0.0, 0.1, 0.2, 0.4}) {
      const Weighted all = weighted(share, speed, [](double) { return 1.0; });
      const Weighted own = weighted(
          share, speed, [&](double nis) { return 1.0 / mover_factor(nis, 1.0, share, speed); });
      EXPECT_GT(own.information, all.information - 1e-12) << share << " " << speed;
      if (share == 0.0) {
        before = all.nees;  // the gate leaves out large residuals of the static scene, too
        EXPECT_NEAR(own.nees, all.nees, 1e-12);
      } else {
        EXPECT_LT(own.nees - before, 0.75 * (all.nees - before)) << share << " " << speed;
        EXPECT_LT(own.nees, 1.35) << share << " " << speed;
      }
    }
  }
}

TEST(NoiseInflation, MoverFactorGrowsWithTheResidualAndTheShare) {
  EXPECT_EQ(mover_factor(5.0, 0.1, 0.4, 0.0), 1.0);
  EXPECT_EQ(mover_factor(5.0, 0.1, 0.0, 1.5), 1.0);
  EXPECT_LT(mover_factor(0.0, 0.1, 0.4, 1.5), 1.15);
  EXPECT_LT(mover_factor(1.0, 0.1, 0.4, 1.5), mover_factor(5.0, 0.1, 0.4, 1.5));
  EXPECT_LT(mover_factor(5.0, 0.1, 0.2, 1.5), mover_factor(5.0, 0.1, 0.4, 1.5));
  // 1 / p^2, p by Bayes' rule
  const double p = 0.6 * std::exp(-2.0) / (0.1 * std::sqrt(2.0 * M_PI));
  EXPECT_NEAR(mover_factor(4.0, 0.1, 0.4, 1.5), std::pow((p + 0.4 / 3.0) / p, 2.0), 1e-12);
}

TEST(NoiseInflation, ShareOfMoversFollowsTheLastSeconds) {
  MoverShare share;
  EXPECT_NEAR(share.share(), 0.1, 1e-12);
  for (int i = 0; i < 100; ++i) share.add(12.0, 8.0, 0.1);
  EXPECT_NEAR(share.share(), 0.4, 0.02);
  for (int i = 0; i < 30; ++i) share.add(20.0, 0.0, 0.1);  // three seconds, rates do not matter
  EXPECT_NEAR(share.share(), 0.4 * std::exp(-3.0), 0.02);
  for (int i = 0; i < 100; ++i) share.add(1.0, 9.0, 0.1);
  EXPECT_EQ(share.share(), 0.5);
}

}  // namespace
}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/nees.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/random_state.hpp"

namespace rio::eval {
namespace {

TEST(BodyError, IsWhatTakesTheEstimateToTheTruth) {
  NavState estimate;
  estimate.q_WB = quaternion_exp({0.3, -0.8, 1.9});
  estimate.p_WB = {1.0, 2.0, 3.0};
  estimate.v_WB = {-1.0, 0.5, 0.0};
  BodyError expected;
  expected << 0.02, -0.03, 0.05, 0.1, 0.2, -0.3, 0.4, -0.5, 0.6, 1e-3, 2e-3, -3e-3, 0.01, -0.02,
      0.03;
  const NavState truth = test::perturbed(estimate, expected);
  EXPECT_LT((body_error(estimate, truth) - expected).norm(), 1e-15);
  StateError reordered;
  reordered << 0.1, 0.2, -0.3, 0.02, -0.03, 0.05, 0.4, -0.5, 0.6;
  EXPECT_LT((state_error(estimate, truth) - reordered).norm(), 1e-15);
}

TEST(Nees, OfKnownErrors) {
  const Vector3d error(0.1, -0.4, 3.0);
  Matrix3d P = Vector3d(0.01, 0.04, 9.0).asDiagonal();
  EXPECT_NEAR(nees(error, P), 1.0 + 4.0 + 1.0, 1e-14);
  // correlated: P = A A^T and error = A w have NEES |w|^2
  Matrix3d A;
  A << 1.0, 0.0, 0.0, 0.5, 2.0, 0.0, -0.3, 0.7, 0.1;
  EXPECT_NEAR(nees(A * Vector3d(1.0, 2.0, -3.0), A * A.transpose()), 14.0, 1e-10);
}

TEST(Nees, OfPartOfABodyCovariance) {
  BodyCovariance P = BodyCovariance::Identity() * 4.0;
  P(12, 12) = -1.0;  // outside the part
  const BodyError error = BodyError::Ones();
  EXPECT_NEAR(nees(error.head<9>(), P.topLeftCorner<9, 9>()), 9.0 / 4.0, 1e-14);
  EXPECT_TRUE(std::isnan(nees(error, P)));
}

TEST(Anees, IsTheMean) {
  EXPECT_DOUBLE_EQ(anees({1.0, 2.0, 6.0}), 3.0);
  EXPECT_TRUE(std::isnan(anees({})));
}

TEST(AneesBounds, EqualTheTextbook) {
  // Bar-Shalom et al., 2001, sec. 5.4.2: 50 runs, 2 states, 95 %: chi2_100 quantiles over 50
  const AneesBounds bounds = anees_bounds(2, 50, 0.95);
  EXPECT_NEAR(bounds.lower, 74.22193 / 50.0, 1e-6);
  EXPECT_NEAR(bounds.upper, 129.56120 / 50.0, 1e-6);
  EXPECT_TRUE(bounds.contain(2.0));
  EXPECT_FALSE(bounds.contain(1.48));
  EXPECT_FALSE(bounds.contain(2.60));
}

TEST(AneesBounds, HoldTheirShareOfMonteCarloTrials) {
  // errors drawn from P = A A^T, 4000 trials of the mean over 10 runs in 3 dimensions
  Matrix3d A;
  A << 0.3, 0.0, 0.0, -0.2, 0.5, 0.0, 0.1, 0.4, 2.0;
  const Matrix3d P = A * A.transpose();
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  const AneesBounds bounds = anees_bounds(3, 10, 0.9);
  const int trials = 4000;
  int below = 0;
  int above = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> runs;
    for (int run = 0; run < 10; ++run) {
      const double x = normal(generator);
      const double y = normal(generator);
      runs.push_back(nees(A * Vector3d(x, y, normal(generator)), P));
    }
    const double value = anees(runs);
    if (value < bounds.lower) ++below;
    if (value > bounds.upper) ++above;
  }
  // each tail holds 5 %, binomial sigma sqrt(0.05 * 0.95 / 4000) = 0.0034; four of them
  EXPECT_NEAR(static_cast<double>(below) / trials, 0.05, 0.014);
  EXPECT_NEAR(static_cast<double>(above) / trials, 0.05, 0.014);
}

}  // namespace
}  // namespace rio::eval

// SPDX-License-Identifier: BSD-3-Clause
// Robust kernels: cost and weight belong together, and to the formulas of their authors.
#include "rio/smoother/kernel.hpp"

#include <gtest/gtest.h>

namespace rio::test {
namespace {

constexpr double kSize = 2.5;

class KernelTest : public testing::TestWithParam<Kernel> {};

TEST_P(KernelTest, CostIsTheIntegralOfTheWeight) {
  // Simpson's rule over a step h errs by h^4 / 180 of the fourth derivative, below 1 here; the
  // kink of the weight at k lies on a grid point, so that no step spans it
  constexpr int kSteps = 4000;
  constexpr double kEnd = 8.0 * kSize;
  constexpr double h = kEnd / kSteps;
  double integral = 0.0;
  for (int i = 0; i < kSteps; i += 2) {
    const double x = i * h;
    integral += h / 3.0 *
                (evaluate_kernel(GetParam(), kSize, x).weight +
                 4.0 * evaluate_kernel(GetParam(), kSize, x + h).weight +
                 evaluate_kernel(GetParam(), kSize, x + 2.0 * h).weight);
    EXPECT_NEAR(evaluate_kernel(GetParam(), kSize, x + 2.0 * h).cost, integral, 1e-9);
  }
}

TEST_P(KernelTest, BeginsAsTheSquareAndNeverGivesMoreWeight) {
  EXPECT_EQ(evaluate_kernel(GetParam(), kSize, 0.0).cost, 0.0);
  EXPECT_EQ(evaluate_kernel(GetParam(), kSize, 0.0).weight, 1.0);
  double weight = 1.0;
  for (double x = 0.1; x < 1e4; x *= 1.3) {
    const KernelValue value = evaluate_kernel(GetParam(), kSize, x);
    EXPECT_LE(value.weight, weight);
    EXPECT_GT(value.weight, 0.0);
    weight = value.weight;
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, KernelTest,
                         testing::Values(Kernel::kNone, Kernel::kHuber, Kernel::kCauchy,
                                         Kernel::kDcs));

TEST(Kernel, TakesTheWeightsOfItsAuthors) {
  // in the residual e = sqrt(x), with c = sqrt(k): Huber c / e, Cauchy 1 / (1 + (e / c)^2); dynamic
  // covariance scaling s^2 with s = min(1, 2 k / (k + x))
  constexpr double e = 4.0;
  constexpr double x = e * e;
  const double c = std::sqrt(kSize);
  EXPECT_NEAR(evaluate_kernel(Kernel::kHuber, kSize, x).weight, c / e, 1e-15);
  EXPECT_NEAR(evaluate_kernel(Kernel::kCauchy, kSize, x).weight, 1.0 / (1.0 + x / (c * c)), 1e-15);
  const double s = 2.0 * kSize / (kSize + x);
  EXPECT_NEAR(evaluate_kernel(Kernel::kDcs, kSize, x).weight, s * s, 1e-15);
  // Huber in e: e^2 / 2 -> c |e| - c^2 / 2; DCS is bounded by 3 k
  EXPECT_NEAR(0.5 * evaluate_kernel(Kernel::kHuber, kSize, x).cost, c * e - 0.5 * c * c, 1e-14);
  EXPECT_LT(evaluate_kernel(Kernel::kDcs, kSize, 1e9).cost, 3.0 * kSize);
}

}  // namespace
}  // namespace rio::test

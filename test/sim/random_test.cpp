// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/random.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <utility>

namespace rio::sim {
namespace {

using Eigen::ArrayXd;

constexpr int kDraws = 200000;

TEST(Random, MatchesTheReferenceOutputOfPcg32) {
  Random random(42, 54);  // pcg32-demo of the reference implementation
  for (const std::uint32_t expected :
       {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U, 0x83d2f293U, 0xbfa4784bU, 0xcbed606eU}) {
    EXPECT_EQ(random.next(), expected);
  }
}

TEST(Random, UniformFillsItsIntervalEvenly) {
  Random random(1);
  const ArrayXd x = ArrayXd::NullaryExpr(kDraws, [&] { return random.uniform(-1.0, 3.0); });
  EXPECT_GE(x.minCoeff(), -1.0);
  EXPECT_LT(x.maxCoeff(), 3.0);
  // five standard errors: 1.155/sqrt(n) = 0.0026, and 1.19/sqrt(n) = 0.0027
  EXPECT_NEAR(x.mean(), 1.0, 0.013);
  EXPECT_NEAR((x - 1.0).square().mean(), 4.0 / 3.0, 0.014);
}

TEST(Random, NormalHasTheMomentsOfAGaussian) {
  Random random(2);
  const ArrayXd x = ArrayXd::NullaryExpr(kDraws, [&] { return random.normal(); });
  // five standard errors of each moment
  EXPECT_NEAR(x.mean(), 0.0, 5.0 / std::sqrt(kDraws));
  EXPECT_NEAR(x.square().mean(), 1.0, 5.0 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(x.pow(4).mean(), 3.0, 5.0 * std::sqrt(96.0 / kDraws));
  const ArrayXd lagged = x.tail(kDraws - 1) * x.head(kDraws - 1);
  EXPECT_NEAR(lagged.mean(), 0.0, 5.0 / std::sqrt(kDraws));
}

TEST(Random, SeedsAndStreamsAreUncorrelated) {
  for (const auto& [seed, stream] : {std::pair{8, 1}, std::pair{7, 2}}) {
    Random a(7, 1);
    Random b(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(stream));
    double product = 0.0;
    for (int i = 0; i < kDraws; ++i) product += a.normal() * b.normal();
    EXPECT_NEAR(product / kDraws, 0.0, 5.0 / std::sqrt(kDraws)) << seed << " " << stream;
  }
}

}  // namespace
}  // namespace rio::sim

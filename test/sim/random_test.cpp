// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>

namespace rio::sim {
namespace {

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
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.uniform(-1.0, 3.0);
    ASSERT_GE(x, -1.0);
    ASSERT_LT(x, 3.0);
    sum += x;
    squares += (x - 1.0) * (x - 1.0);
  }
  // five standard errors: 1.155/sqrt(n) = 0.0026, and 1.19/sqrt(n) = 0.0027
  EXPECT_NEAR(sum / kDraws, 1.0, 0.013);
  EXPECT_NEAR(squares / kDraws, 4.0 / 3.0, 0.014);
}

TEST(Random, NormalHasTheMomentsOfAGaussian) {
  Random random(2);
  double sum = 0.0;
  double squares = 0.0;
  double fourth = 0.0;
  double lagged = 0.0;
  double last = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    lagged += x * last;
    last = x;
  }
  // five standard errors of each moment
  EXPECT_NEAR(sum / kDraws, 0.0, 5.0 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1.0, 5.0 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(fourth / kDraws, 3.0, 5.0 * std::sqrt(96.0 / kDraws));
  EXPECT_NEAR(lagged / kDraws, 0.0, 5.0 / std::sqrt(kDraws));
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

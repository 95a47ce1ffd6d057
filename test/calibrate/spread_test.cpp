// SPDX-License-Identifier: BSD-3-Clause
// Means of measurements and how far they are apart, in numbers done by hand.
#include "calibrate/spread.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rio::calibrate {
namespace {

TEST(Spread, MeanIsWeightedByTheInverseVariances) {
  const Combined c = combine({{1.0, 1.0}, {4.0, 2.0}});
  EXPECT_NEAR(c.value, (1.0 + 4.0 / 4.0) / 1.25, 1e-15);
  EXPECT_NEAR(c.sigma, 1.0 / std::sqrt(1.25), 1e-15);
  EXPECT_EQ(c.dof, 1);
  EXPECT_NEAR(c.chi2, 0.6 * 0.6 + 1.2 * 1.2, 1e-12);  // the mean is 1.6
}

TEST(Spread, OneMeasurementHasNone) {
  const Combined c = combine({{3.0, 0.5}});
  EXPECT_EQ(c.value, 3.0);
  EXPECT_EQ(c.sigma, 0.5);
  EXPECT_EQ(c.chi2, 0.0);
  EXPECT_EQ(c.dof, 0);
}

TEST(Spread, OfTwoChiSquaredIsTheSquareOfHowFarTheyAreApart) {
  const Measured a{1.0, 0.3};
  const Measured b{2.5, 0.4};
  EXPECT_NEAR(apart(a, b), 3.0, 1e-12);
  EXPECT_NEAR(combine({a, b}).chi2, 9.0, 1e-12);
}

}  // namespace
}  // namespace rio::calibrate

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/core/chi2.hpp"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>

namespace rio {
namespace {

struct TableRow {
  double probability;
  double dof;
  double quantile;
};

// NIST/SEMATECH e-Handbook 1.3.6.7.4, continued to 13 digits with mpmath
constexpr TableRow kTable[] = {
    {0.95, 1, 3.841458820694},    {0.99, 1, 6.634896601021},  {0.999, 1, 10.82756617066},
    {0.05, 1, 0.00393214000002},  {0.95, 2, 5.991464547108},  {0.99, 3, 11.34486673014},
    {0.9, 5, 9.236356899781},     {0.975, 9, 19.02276779864}, {0.025, 9, 2.70038949998},
    {0.95, 15, 24.99579013973},   {0.01, 30, 14.95345652846}, {0.99, 100, 135.806723171},
    {0.005, 100, 67.32756330548},
};

TEST(Chi2, EqualsTheTables) {
  for (const TableRow& row : kTable) {
    SCOPED_TRACE(testing::Message() << row.probability << " " << row.dof);
    // relative: the table has 13 digits
    EXPECT_NEAR(chi2_quantile(row.probability, row.dof), row.quantile, 1e-10 * row.quantile);
    EXPECT_NEAR(chi2_cdf(row.quantile, row.dof), row.probability, 1e-10);
  }
}

TEST(Chi2, CdfIsTheInverseOfTheQuantile) {
  for (const double dof : {1.0, 2.0, 3.0, 9.0, 15.0, 39.0, 40.0, 41.0, 450.0, 1e5}) {
    for (const double p : {1e-9, 1e-3, 0.025, 0.3, 0.5, 0.7, 0.975, 0.9999, 1.0 - 1e-9}) {
      EXPECT_NEAR(chi2_cdf(chi2_quantile(p, dof), dof), p, 1e-11) << p << " " << dof;
    }
  }
}

TEST(Chi2, ClosedFormsForOneAndTwoDegrees) {
  for (double x = 1e-6; x < 60.0; x *= 1.3) {
    EXPECT_NEAR(chi2_cdf(x, 1.0), std::erf(std::sqrt(0.5 * x)), 1e-14) << x;
    EXPECT_NEAR(chi2_cdf(x, 2.0), -std::expm1(-0.5 * x), 1e-14) << x;
  }
  EXPECT_NEAR(chi2_quantile(0.99, 2.0), -2.0 * std::log(0.01), 1e-13);
  // chi2_cdf(x, 1) ~ sqrt(2 x / pi) for x -> 0
  EXPECT_NEAR(chi2_quantile(1e-12, 1.0) / (0.5 * 3.14159265358979324 * 1e-24), 1.0, 1e-12);
}

// F_{n+2}(x) = F_n(x) - (x/2)^{n/2} e^{-x/2} / Gamma(n/2 + 1) ties series and continued fraction,
// and both ways to the leading factor, which meet at 40 degrees of freedom.
TEST(Chi2, RecurrenceOverDegreesOfFreedom) {
  for (int n = 1; n < 80; ++n) {
    for (double x = 0.1; x < 300.0; x *= 1.2) {
      const double step =
          std::exp(0.5 * n * std::log(0.5 * x) - 0.5 * x) / std::tgamma(0.5 * n + 1.0);
      EXPECT_NEAR(chi2_cdf(x, n) - chi2_cdf(x, n + 2.0), step, 1e-13) << n << " " << x;
    }
  }
}

TEST(Chi2, EdgesOfTheDomain) {
  EXPECT_EQ(chi2_cdf(0.0, 3.0), 0.0);
  EXPECT_EQ(chi2_cdf(-1.0, 3.0), 0.0);
  EXPECT_EQ(chi2_cdf(INFINITY, 3.0), 1.0);
  EXPECT_EQ(chi2_cdf(1e9, 3.0), 1.0);
  EXPECT_TRUE(std::isnan(chi2_cdf(NAN, 3.0)));
  EXPECT_EQ(chi2_quantile(0.0, 3.0), 0.0);
  EXPECT_EQ(chi2_quantile(1.0, 3.0), INFINITY);
  EXPECT_TRUE(std::isnan(chi2_quantile(NAN, 3.0)));
}

// Where the tail is too small for a number the search goes on without an exception.
TEST(Chi2, QuantilesFarOutRaiseNoFloatingPointException) {
  std::feclearexcept(FE_ALL_EXCEPT);
  for (const double dof : {1.0, 3.0, 20.0, 450.0}) {
    for (const double p : {1e-300, 1e-12, 0.5, 0.99, 1.0 - 1e-12, 1.0 - 1.2e-16}) {
      const double x = chi2_quantile(p, dof);
      EXPECT_TRUE(x >= 0.0 && x < 1e4) << p << " " << dof;
    }
  }
  EXPECT_EQ(std::fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO), 0);
}

}  // namespace
}  // namespace rio

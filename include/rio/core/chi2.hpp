// SPDX-License-Identifier: BSD-3-Clause
// The chi-squared distribution: cumulative probability and quantile. C++17.
//
// (E1) cdf(x; n) = P(n/2, x/2), the regularised lower incomplete gamma function
// (E2) P(a, x) = D sum_k x^k / ((a+1)...(a+k)), D = x^a e^-x / Gamma(a+1)       for x < a + 1
// (E3) 1 - P(a, x) = a D / (x+1-a - 1(1-a)/(x+3-a - 2(2-a)/(x+5-a - ...)))    otherwise
// Reference: Press et al., Numerical Recipes, 3rd ed., 6.2. Absolute error below 1e-11 up to 1e6
// degrees of freedom. No global state: std::lgamma, which writes `signgam`, is avoided.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "rio/core/assert.hpp"

namespace rio {

namespace chi2_detail {

/// x^a e^-x / Gamma(a+1), for a > 0 and x > 0.
inline double gamma_density(double a, double x) {
  if (a < 20.0) return std::exp(a * std::log(x) - x) / std::tgamma(a + 1.0);
  // Stirling: the large terms a log(x) and log Gamma(a) cancel before they are rounded
  const double excess = (x - a) / a;
  const double log_ratio = excess > -0.5 ? std::log1p(excess) : std::log(x / a);
  const double inverse = 1.0 / a;
  const double square = inverse * inverse;
  const double correction =
      inverse * (1.0 / 12.0 - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square / 1680.0)));
  return std::exp(a * (log_ratio - excess) - correction) / std::sqrt(2.0 * 3.14159265358979324 * a);
}

/// Probability below x and its complement; the small one is never computed as 1 minus the other.
struct Tails {
  double below;
  double above;
};

inline Tails gamma_tails(double a, double x) {
  const double epsilon = std::numeric_limits<double>::epsilon();
  if (x < a + 1.0) {  // (E2)
    double term = 1.0;
    double sum = 1.0;
    for (double k = 1.0; term > 0.1 * epsilon * sum; k += 1.0) {
      term *= x / (a + k);
      sum += term;
    }
    const double below = gamma_density(a, x) * sum;
    return {below, 1.0 - below};
  }
  const double tiny = 1e-300;  // Lentz: stands in for a denominator that vanishes
  double b = x + 1.0 - a;
  double c = 1.0 / tiny;
  double d = 1.0 / b;
  double fraction = d;
  double change = 0.0;
  for (double k = 1.0; std::abs(change - 1.0) > epsilon && k < 1e5; k += 1.0) {  // (E3)
    const double numerator = -k * (k - a);
    b += 2.0;
    d = numerator * d + b;
    if (std::abs(d) < tiny) d = tiny;
    d = 1.0 / d;
    c = b + numerator / c;
    if (std::abs(c) < tiny) c = tiny;
    change = c * d;
    fraction *= change;
  }
  const double above = a * gamma_density(a, x) * fraction;
  return {1.0 - above, above};
}

}  // namespace chi2_detail

/// Probability that a chi-squared variable with `dof` > 0 degrees of freedom is below x.
inline double chi2_cdf(double x, double dof) {
  RIO_ASSERT(dof > 0.0);
  if (std::isnan(x)) return x;
  if (x <= 0.0) return 0.0;
  if (std::isinf(x)) return 1.0;
  return chi2_detail::gamma_tails(0.5 * dof, 0.5 * x).below;  // (E1)
}

/// The x with chi2_cdf(x, dof) = probability; 0 for probability <= 0, infinity for >= 1. Costs some
/// microseconds: look thresholds up once, not per measurement.
inline double chi2_quantile(double probability, double dof) {
  RIO_ASSERT(dof > 0.0);
  if (std::isnan(probability)) return probability;
  if (probability <= 0.0) return 0.0;
  if (probability >= 1.0) return std::numeric_limits<double>::infinity();
  const double a = 0.5 * dof;
  const bool upper = probability > 0.5;
  const double log_target = upper ? std::log1p(-probability) : std::log(probability);

  // Newton for y = log(x/2) on the logarithm of the smaller tail: both are nearly straight there.
  // It stays inside a bracket, so a step too long becomes a bisection.
  double low = std::log(1e-300);
  double high = std::log(10.0 * a + 1e4);
  double y = std::log(a);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double x = std::exp(y);
    const chi2_detail::Tails tails = chi2_detail::gamma_tails(a, x);
    const double tail = upper ? tails.above : tails.below;
    const bool gone = !(tail > 0.0);  // underflow: far out in the tail
    const double error = gone ? -1.0 : std::log(tail) - log_target;
    ((error < 0.0) == upper ? high : low) = y;
    const double slope =  // d log(tail) / dy
        gone ? 0.0 : (upper ? -a : a) * chi2_detail::gamma_density(a, x) / tail;
    double next = slope == 0.0 ? high : y - error / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double step = std::abs(next - y);
    y = next;
    if (step < 4.0 * std::numeric_limits<double>::epsilon() * std::max(1.0, std::abs(y))) break;
  }
  return 2.0 * std::exp(y);
}

}  // namespace rio

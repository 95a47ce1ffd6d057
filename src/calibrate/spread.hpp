// SPDX-License-Identifier: BSD-3-Clause
// Several measurements of one number: their mean, and whether their differences exceed their
// sigmas.
#pragma once

#include <cmath>
#include <vector>

namespace rio::calibrate {

/// A number and its standard deviation, which is positive.
struct Measured {
  double value = 0.0;
  double sigma = 0.0;
};

/// Mean weighted by the inverse variances.
struct Combined {
  double value = 0.0;
  double sigma = 0.0;  ///< of the mean, if the sigmas are correct
  double chi2 = 0.0;   ///< of the differences from the mean
  int dof = 0;         ///< measurements less one
};

/// At least one measurement.
inline Combined combine(const std::vector<Measured>& measured) {
  double weights = 0.0;
  Combined out;
  for (const Measured& m : measured) {
    const double weight = 1.0 / (m.sigma * m.sigma);
    weights += weight;
    out.value += weight * m.value;
  }
  out.value /= weights;
  out.sigma = 1.0 / std::sqrt(weights);
  for (const Measured& m : measured) {
    const double off = (m.value - out.value) / m.sigma;
    out.chi2 += off * off;
  }
  out.dof = static_cast<int>(measured.size()) - 1;
  return out;
}

/// Measurements farther apart than this contradict each other [sigmas].
inline constexpr double kFarApart = 3.0;

/// |a - b| over the sigma of the difference.
inline double apart(const Measured& a, const Measured& b) {
  return std::abs(a.value - b.value) / std::hypot(a.sigma, b.sigma);
}

}  // namespace rio::calibrate

// SPDX-License-Identifier: BSD-3-Clause
// Several measurements of one number: their mean, and whether their differences exceed their
// sigmas.
#pragma once

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
Combined combine(const std::vector<Measured>& measured);

/// Measurements farther apart than this contradict each other [sigmas].
inline constexpr double kFarApart = 3.0;

/// |a - b| over the sigma of the difference.
double apart(const Measured& a, const Measured& b);

}  // namespace rio::calibrate

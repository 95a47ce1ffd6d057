// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: noise inflation, for errors that repeat from scan to scan while the radar hardly moves,
// and for matches with a neighbour of the landmark. Derivations: data/theory.md, 8.
//
// (E1) correlation with the previous measurement, d travelled since: rho = (1 - f) exp(-d / d0), f
//      the share of the variance that is independent in every scan (receiver noise)
// (E2) the variance is multiplied by (1 + rho) / (1 - rho)
// (E3) a match that is right with probability p: the variance is multiplied by 1 / (2 p - 1)
// (E4) its Doppler: the variance grows by 2 (1 - p) v^T Sigma v, Sigma that of the direction
//
// Reference: Bayley and Hammersley, The "Effective" Number of Independent Observations in an
// Autocorrelated Time Series, 1946 (E2).
#pragma once

#include <cmath>

namespace rio {

/// f of (E1): at rest the error repeats except for about a tenth of its sigma.
inline constexpr double kFreshShare = 0.02;

/// (E2): factor of the variance, 1 if `distance` is 0.
/// @param flown distance travelled since the previous measurement [m], not negative
/// @param distance d0 [m]
inline double repetition_factor(double flown, double distance) {
  if (distance <= 0.0) return 1.0;
  const double rho = (1.0 - kFreshShare) * std::exp(-flown / distance);
  return (1.0 + rho) / (1.0 - rho);
}

/// (E3): c, factor of the variance.
/// @param right probability that a match is right, above a half
inline double mismatch_factor(double right) {
  return 1.0 / (2.0 * right - 1.0);
}

/// (E4): variance that the Doppler of a match has in addition [m^2/s^2].
/// @param right as above
/// @param across v^T Sigma v of the detection [m^2/s^2]
inline double mismatch_variance(double right, double across) {
  return 2.0 * (1.0 - right) * across;
}

}  // namespace rio

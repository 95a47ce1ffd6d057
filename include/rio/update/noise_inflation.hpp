// SPDX-License-Identifier: BSD-3-Clause
// Stage 5: noise inflation, for correlated errors and for mismatches.
//
// The error of a measurement may be correlated from scan to scan: the interference inside a
// reflector changes with the distance travelled, and not at all while the radar is at rest.
//
// (E1) correlation with the previous measurement, d travelled since: rho = (1 - f) exp(-d / d0), f
//      the share of the variance that is independent in every scan (receiver noise)
// (E2) n values of a first-order Gauss-Markov error have as much information about a constant as
//      n (1 - rho) / (1 + rho) independent ones (n large): the variance of each is multiplied by
//      (1 + rho) / (1 - rho)
//
// A match may be of a neighbour of the landmark: it passes the same gate, so its residual is of the
// same size, but it contains no information about this landmark.
//
// (E3) A match that is right with probability p has E[r] = p h dx and var(r) = R, h P h^T small. A
//      filter with the variance c R claims c R / n after n matches. Its gain is 1 / n, so its error
//      obeys e_n = (1 - p / n) e_(n-1) + r / n and has the variance R / (n (2 p - 1)):
//      c = 1 / (2 p - 1)
// (E4) The Doppler of a mismatch is that of the neighbour, in its own direction u': seen from the
//      landmark's direction u, the residual has in addition (u' - u)^T v. With m the measured
//      direction, u' - m is its error, of covariance Sigma, and m - u has passed the gate of the
//      directions: of the same size, and independent of u' - m. On average over the matches the
//      variance of the Doppler is larger by 2 (1 - p) v^T Sigma v. Without it the landmarks are
//      drawn to their neighbours, and the position drifts in one direction of the body.
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

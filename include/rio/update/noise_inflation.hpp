// SPDX-License-Identifier: BSD-3-Clause
// Stage 6: noise inflation, for errors that repeat and for mismatches.
//
// The error of a measurement may repeat: the interference inside a reflector changes with the
// distance flown, and not at all while the radar rests.
//
// (E1) correlation with the measurement before it, d flown since: rho = (1 - f) exp(-d / d0), f the
//      share of the variance that is new in every scan (receiver noise)
// (E2) n values of a first-order Gauss-Markov error tell of a constant what n (1 - rho) / (1 + rho)
//      independent ones do (n large), so each counts with its variance times (1 + rho) / (1 - rho)
//
// A measurement may be of a neighbour of the landmark, whose residual the same gate makes as large
// but which tells nothing of this one.
//
// (E3) A match that is right with probability p has E[r] = p h dx and var(r) = R, h P h^T small. A
//      filter told c R claims c R / n after n matches. Its gain is 1 / n, so that its error obeys
//      e_n = (1 - p / n) e_(n-1) + r / n and has the variance R / (n (2 p - 1)): c = 1 / (2 p - 1)
//
// Reference: Bayley and Hammersley, The "Effective" Number of Independent Observations in an
// Autocorrelated Time Series, 1946 (E2).
#pragma once

#include <cmath>

namespace rio {

/// f: at rest a scan repeats but for a tenth of its sigma.
inline constexpr double kFreshShare = 0.02;

/// (E2): factor of the variance, 1 if `distance` is 0.
/// @param flown since the measurement before [m], not negative
/// @param distance d0 [m]
inline double repetition_factor(double flown, double distance) {
  if (distance <= 0.0) return 1.0;
  const double rho = (1.0 - kFreshShare) * std::exp(-flown / distance);
  return (1.0 + rho) / (1.0 - rho);
}

/// (E3): factor of the variance.
/// @param right probability that a match is right, above a half
inline double mismatch_factor(double right) {
  return 1.0 / (2.0 * right - 1.0);
}

}  // namespace rio

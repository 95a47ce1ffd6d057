// SPDX-License-Identifier: BSD-3-Clause
// Stage 6: noise inflation, for correlated errors, for mismatches and for movers.
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
//
// A Doppler of a mover may pass the gate as well. Unlike that of a neighbour its residual is spread
// evenly, so the size of the residual tells how likely it is.
//
// (E4) A share e of the detections moves, with Dopplers within +-w of those of the static scene. A
//      residual of variance S has the likelihood (1 - e) N(r; 0, S) + e / (2 w), whose logarithm
//      has the score p r / S, p the probability that the detection is static given r:
//      1 / p = 1 + e / (2 w (1 - e) N(r; 0, S)). With c = 1 / p a filter has that score but claims
//      the information p / S, of which p (1 - p) r^2 / S^2 is missing: c = 1 / p^2, which loses
//      less than 4 % of the information and is overconfident by half as much as c = 1 / p
//
// Reference: Bayley and Hammersley, The "Effective" Number of Independent Observations in an
// Autocorrelated Time Series, 1946 (E2); Bar-Shalom and Tse, Tracking in a Cluttered Environment
// with Probabilistic Data Association, 1975 (E4).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// (E3): factor of the variance.
/// @param right probability that a match is right, above a half
inline double mismatch_factor(double right) {
  return 1.0 / (2.0 * right - 1.0);
}

/// (E4): factor of the variance.
/// @param nis normalised innovation squared r^2 / S
/// @param sigma sqrt(S) [m/s]
/// @param share e, of the detections that move
/// @param speed w [m/s]; 0: 1 is returned
inline double mover_factor(double nis, double sigma, double share, double speed) {
  if (speed <= 0.0) return 1.0;
  const double density = std::exp(-0.5 * nis) / (sigma * std::sqrt(2.0 * std::numbers::pi));
  const double inverse = 1.0 + share / (2.0 * speed * (1.0 - share) * density);
  return inverse * inverse;
}

/// e of (E4): share of movers in the detections of the last seconds.
class MoverShare {
 public:
  /// @param statics, movers numbers of detections of a scan, @param seconds since the one before
  void add(double statics, double movers, double seconds) {
    const double kept = std::exp(-seconds / kMemory);
    statics_ = kept * statics_ + statics;
    movers_ = kept * movers_ + movers;
  }
  /// At most a half: the static set is the largest.
  double share() const {
    return std::min(0.5, (movers_ + kUsual * kWeight) / (statics_ + movers_ + kWeight));
  }

 private:
  static constexpr double kMemory = 1.0;  ///< people come into view and leave it within seconds [s]
  static constexpr double kUsual = 0.1;   ///< share before anything was seen
  static constexpr double kWeight = 5.0;  ///< of it, in detections

  double statics_ = 0.0;
  double movers_ = 0.0;
};

}  // namespace rio

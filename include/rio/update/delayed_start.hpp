// SPDX-License-Identifier: BSD-3-Clause
// Stages 3 and 4 for auxiliary states that are not known at the start (AuxiliaryState::delayed),
// like the place of an anchor that measures ranges only: a linearised update from a wrong place
// would turn the whole estimate. Their measurements are held back until they determine the state,
// which then joins the estimate with its correlations.
//
// (E1) a = argmin |a - a_0|^2 / sigma_0^2 + sum_i rho(w_i |r_i(x_i, a)|^2), rho Huber's, then
//      truncated at 9, by Levenberg and Marquardt's method from a_0, from a_0 +- sigma_0 along each
//      axis and likewise around the best of these
// (E2) 1 / w_i = 1 + Jp_i (P_p - P_p,i) Jp_i^T, the noise of a row of unit variance and what the
//      position has drifted since; Jp_i its derivative in the position
// (E3) an error dx of the body state now has moved the states x_i as a rigid body, dx_i = G_i dx,
//      and so a by F dx, F = -H^-1 sum_i w_i Ja_i^T Jx_i G_i, H the information of (E1):
//      P_ax = F P_bx, P_aa = F P_bb F^T + H^-1 (I / sigma_0^2 + sum_i w_i^2 Ja_i^T Ja_i
//      + sum_k S_k Q_k S_k^T) H^-1, S_k = sum_{i <= k} w_i Ja_i^T Jp_i: the drift between two
//      measurements, Q_k = P_p,k+1 - P_p,k (the last: to now), is an error of all before it
// (E4) determined: any other minimum, more than 3 sigma away, has a cost higher by 18 (above 4
//      sigma); the linearised rows are off by less than their noise (RMS) at a +- 3 L^-T e_k,
//      H = L L^T; four of five rows fit within 3 sigma
// Not modelled: the error of other auxiliary states of the same measurements; drift that two states
// with a delayed start share. Auxiliary states are not part of the observability constraint
// (ekf/reexpression.hpp, smoother/prior.hpp). Derivation: data/theory.md, 13.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rio/options.hpp"
#include "rio/update/aiding.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

/// An auxiliary state that its measurements have determined.
struct DelayedStart {
  static constexpr int kMax = AuxiliaryState::kMaxSize;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMax, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMax, kMax>;
  using ByBody = Eigen::Matrix<double, Eigen::Dynamic, body::kSize, 0, kMax, body::kSize>;

  int first = 0;   ///< its first element among the auxiliary states
  Vector value;    ///< [its unit]
  ByBody by_body;  ///< F of (E3)
  Matrix noise;    ///< covariance given the body state
};

/// A measurement that waits, with the estimate of its time.
struct HeldMeasurement {
  AidingMeasurement z;
  AidedState then;
  Matrix3d position_covariance;  ///< [m^2]
};

/// An auxiliary state that has a delayed start.
struct DelayedState {
  static constexpr std::size_t kMostHeld = 64;

  AuxiliaryState declared;
  int first = 0;  ///< its first element among the auxiliary states
  bool waits = true;
  Time interval{0};  ///< least, between two that are kept: 64 of them span the whole wait
  Time next_try{0};
  std::vector<HeldMeasurement> held;
};

class DelayedStarts {
 public:
  explicit DelayedStarts(const Options& options);

  /// All states with a delayed start wait again.
  void reset();

  /// A state waits for its start.
  bool any() const;
  /// The state with that first element does.
  bool waits(int first) const;

  /// Keeps a measurement that depends on a state that waits; drops it if it depends on two. False:
  /// it can be used.
  /// @param x the estimate at the time of the update
  bool hold(const AidingObservation& z, const StateEstimate& x);

  /// A state that the measurements held determine now; it waits no longer. Null if there is none.
  /// At most one attempt per second of measurements.
  const DelayedStart* determine(const StateEstimate& x);

 private:
  /// (E4) and, if it is so, (E3), in start_.
  bool fit(const DelayedState& state, const StateEstimate& x);

  AuxiliaryStates states_;
  double gravity_;
  std::vector<DelayedState> delayed_;
  DelayedStart start_;
};

}  // namespace rio

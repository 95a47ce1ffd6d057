// SPDX-License-Identifier: BSD-3-Clause
// Gauss-Newton over the window and the border, with Levenberg-Marquardt damping after a step that
// increases the cost.
//
// (E1) length of a step in sigmas: sqrt(dx^T H dx) = sqrt(dx . g), the Newton decrement. A distant
//      landmark may move by centimetres and yet by a small fraction of its sigma.
// The factor of a step is reused for the next steps as long as each is much shorter than the one
// before (SmootherOptions::factor_reuse): the simplified Newton method (Deuflhard 2011, ch. 2). It
// has the same solution, the zero of g. The covariance is that at the point where the factor was
// computed, its sigmas off by up to 5 %; what is marginalised into the prior is always linearised
// at the solution.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rio/options.hpp"
#include "rio/smoother/normal_equations.hpp"
#include "rio/smoother/window.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

/// A copy of the unknowns, to restore them.
class WindowPoint {
 public:
  explicit WindowPoint(std::size_t max_states) : navs_(max_states) {}

  void save(const Window& window, const Estimate& x) {
    for (std::size_t k = 0; k < window.size(); ++k) navs_[k] = window[k].nav;
    estimate_ = x;
  }
  void restore(Window* window, Estimate* x) const {
    for (std::size_t k = 0; k < window->size(); ++k) (*window)[k].nav = navs_[k];
    *x = estimate_;
  }

 private:
  std::vector<NavState> navs_;
  Estimate estimate_;
};

class GaussNewton {
 public:
  /// @param border largest size of calibration and landmarks
  GaussNewton(const SmootherOptions& options, int max_states, int border);

  /// Moves window and state estimate to the minimum; the newest state is the state estimate's. The
  /// factor of the system is undamped afterwards. False if a system cannot be solved.
  /// @param build builds the system at the current point and returns its cost
  template <class Build>
  bool minimise(const Build& build, NormalEquations* system, Window* window,
                StateEstimate* state_estimate) {
    double damping = 0.0;
    double last = kNone;  // length of the previous step, if undamped
    double cost = build();
    bool converged = false;
    for (int i = 0; i < options_.max_iterations; ++i) {
      double length = last < kNone ? step(*system) : kNone;
      if (!(length < options_.factor_reuse * last)) {
        if (!system->factorise(damping)) return false;
        length = step(*system);
      }
      if (!(length < kNone)) return false;
      saved_.save(*window, state_estimate->estimate());
      apply(*system, window, state_estimate);
      converged = length < options_.tolerance;
      if (converged) break;
      const double next = build();
      // at the steady motion g is not quite the gradient of the cost: a shorter next step is as
      // good
      if (next <= cost + kCostRounding * std::abs(cost) || step(*system) < length) {
        cost = next;
        last = damping == 0.0 ? length : kNone;
        damping = damping > kLeastDamping ? 0.1 * damping : 0.0;
      } else {
        saved_.restore(window, &state_estimate->estimate());
        cost = build();
        last = kNone;
        damping = std::max(kLeastDamping, 10.0 * damping);
      }
    }
    return (converged && damping == 0.0) || system->factorise();
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  static constexpr double kLeastDamping = 1e-4;
  static constexpr double kCostRounding = 1e-9;

  /// Solves for dx_ with the current factor; returns its length in sigmas (E1), infinite if dx_ is
  /// not finite.
  double step(const NormalEquations& system);

  void apply(const NormalEquations& system, Window* window, StateEstimate* state_estimate);

  SmootherOptions options_;
  WindowPoint saved_;
  Eigen::VectorXd dx_;
  Eigen::VectorXd tail_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// A prior of the sliding window about random states, and the window that it is applied to.
#pragma once

#include <gtest/gtest.h>

#include "rio/sim/random.hpp"
#include "rio/smoother/prior.hpp"
#include "support/dense_rows.hpp"
#include "support/random_state.hpp"

namespace rio::test {

inline constexpr int kStates = 3;  // of the window; the prior knows the first two
inline constexpr int kLeading = 2;
inline constexpr int kLandmarks = 4;  // of the window; the prior knows the first three
inline constexpr int kKnown = 3;

inline constexpr int kCalibration = 9;

inline CalibrationOptions calibration() {
  return {0.05, 0.03, 0.02, 0.02, 0.03, 0.04};
}

/// Unknowns, order [states | calibration | landmarks].
struct Point {
  Layout layout{calibration(), 0, kLandmarks};
  Window window{kStates, Options{}};
  Estimate x;

  int landmarks() const { return static_cast<int>(x.landmarks.size()); }
  int border() const { return kCalibration + 3 * landmarks(); }
  int unknowns() const { return body::kSize * kStates + border(); }

  Point moved(const VectorXd& e) const {
    Point out = *this;
    for (int s = 0; s < kStates; ++s) {
      NavState& nav = out.window[static_cast<std::size_t>(s)].nav;
      nav = perturbed(nav, e.segment<15>(body::kSize * s));
    }
    int at = body::kSize * kStates;
    out.x.T_BS.rotation = x.T_BS.rotation * rotation_of(e.segment<3>(at));
    out.x.T_BS.translation += e.segment<3>(at + 3);
    out.x.doppler_scale += e[at + 6];
    out.x.time_offset += e[at + 7];
    out.x.elevation_error += e[at + 8];
    at += kCalibration;
    for (LandmarkState& l : out.x.landmarks) {
      l.p_W += e.segment<3>(at);
      at += 3;
    }
    return out;
  }
  /// Of the prior alone; its system if wanted.
  double cost(Prior* prior, NormalEquations* system) const {
    system->clear(kStates, border());
    return prior->add_to(system, window, x);
  }
  NormalEquations system() const { return {kStates, border()}; }
  /// Central differences: error h^2 of the third derivative and 1e-16 / h of the cost.
  VectorXd slope(Prior* prior) const {
    constexpr double h = 1e-5;
    NormalEquations unused = system();
    VectorXd out(unknowns());
    for (int i = 0; i < unknowns(); ++i) {
      const VectorXd e = h * VectorXd::Unit(unknowns(), i);
      out[i] = (moved(e).cost(prior, &unused) - moved(-e).cost(prior, &unused)) / (2.0 * h);
    }
    return out;
  }
};

class PriorTest : public testing::Test {
 protected:
  PriorTest() {
    for (int s = 0; s < kStates; ++s) made_.window.push().nav = random_.state();
    made_.x.T_BS = {random_.rotation(), random_.normal_vector()};
    made_.x.doppler_scale = 0.01;
    made_.x.time_offset = 0.01;
    made_.x.elevation_error = 0.02;
    for (int i = 0; i < kKnown; ++i) made_.x.landmarks.push_back({random_.normal_vector(5.0)});
  }

  /// Of the prior, and the column of landmark i in it.
  static constexpr int kSize = body::kSize * kLeading + kCalibration + 3 * kKnown;
  static int landmark(int i) { return kSize - 3 * (kKnown - i); }

  Prior made_of(const MatrixXd& A, const VectorXd& g) const {
    Prior prior(made_.layout, kStates);
    prior.assign(A, g, made_.window, 0, kLeading, made_.x);
    return prior;
  }
  MatrixXd random_information(int n = kSize) {
    const MatrixXd L = random_matrix(numbers_, n, n);
    return L * L.transpose() + MatrixXd::Identity(n, n);
  }
  VectorXd random_vector(int n) { return random_matrix(numbers_, n, 1); }
  /// The states have moved far, and a landmark has come.
  Point later() {
    Point out = made_.moved(0.3 * random_vector(made_.unknowns()));
    out.x.landmarks.push_back({random_.normal_vector(5.0)});
    return out;
  }

  sim::Random numbers_{41};
  Random random_{41};
  Point made_;  ///< where the prior is made
};

}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
// An auxiliary state from the measurements held for it: (E1) to (E4) of update/delayed_start.hpp.
#pragma once

#include "rio/update/delayed_start.hpp"

namespace rio {

class DelayedFit {
 public:
  DelayedFit(const DelayedState& state, const AuxiliaryStates& states, const StateEstimate& x);

  /// (E4) and, if it is so, (E3).
  bool solve(DelayedStart* out) const;

 private:
  using Vector = DelayedStart::Vector;
  using Matrix = DelayedStart::Matrix;

  /// A whitened row, residual = Ja da + Jx dx + n. Outside of the model's domain: a residual of 10
  /// sigma and no Jacobian.
  struct Row {
    double residual = 0.0;
    Vector Ja;                                              ///< in the auxiliary state
    Eigen::Matrix<double, 1, AidingMeasurement::kBody> Jx;  ///< in the body state of its time
    double variance = 1.0;                                  ///< (E2)
    const HeldMeasurement* of = nullptr;

    double squared() const { return residual * residual / variance; }
  };
  /// rho(r^2) of (E1), and its derivative.
  struct Loss {
    double value = 0.0;
    double weight = 0.0;
  };
  using LossFunction = Loss (*)(double);
  static Loss huber(double squared);
  static Loss truncated(double squared);

  struct Minimum {
    Vector a;
    double cost = 0.0;
  };
  using Minima = StaticVector<Minimum, 4 * static_cast<std::size_t>(DelayedStart::kMax) + 1>;

  /// f(row) of all measurements, in their order.
  template <class F>
  void for_each_row(const Vector& a, const F& f) const;
  double prior_information() const;
  double cost(const Vector& a, LossFunction loss) const;
  /// Information and gradient of half the cost; returns the cost.
  double linearise(const Vector& a, LossFunction loss, Matrix* H, Vector* g) const;
  Minimum descend(Vector a, LossFunction loss) const;
  /// The minimum reached from a: with Huber's loss, which leads there despite outliers, then with
  /// the truncated one, which outliers do not bias.
  Minimum minimum(const Vector& a) const { return descend(descend(a, huber).a, truncated); }
  /// Those reached from a +- sigma_0 along each axis.
  void add_minima_around(const Vector& a, Minima* minima) const;
  static const Minimum& best_of(const Minima& minima);

  /// What the linearised rows miss at 3 sigma is below their noise, RMS.
  bool is_linear(const Vector& a, const Matrix& H) const;
  double missed(const Vector& a, const Vector& step) const;
  double share_that_fits(const Vector& a) const;
  /// (E3)
  void start(const Vector& a, const Matrix& H, DelayedStart* out) const;

  const DelayedState& state_;
  const AuxiliaryStates& states_;
  const StateEstimate& x_;
  Matrix3d position_covariance_;  ///< now
  Vector initial_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// An auxiliary state from the measurements held for it.
#include "rio/update/delayed_start.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "rio/core/so3.hpp"

namespace rio {

namespace {

constexpr double kBound = 9.0;  // of a chi-squared value: three sigmas

/// G of (E3): the error of a state before by that of the state now: the path is displaced as a
/// rigid body; velocity, beside its rotation, and gyro bias have kept their errors.
Eigen::Matrix<double, AidingMeasurement::kBody, body::kSize> displaced(const AidedState& then,
                                                                       const RigidPose& now) {
  Eigen::Matrix<double, AidingMeasurement::kBody, body::kSize> G;
  G.setZero();
  G.diagonal().setOnes();
  G.block<3, 3>(body::kAttitude, body::kAttitude) = then.T_WB.R.transpose() * now.R;
  G.block<3, 3>(body::kPosition, body::kAttitude) = -skew(then.T_WB.p - now.p) * now.R;
  G.block<3, 3>(body::kVelocity, body::kAttitude) = -skew(then.v_WB) * now.R;
  return G;
}

class DelayedFit {
 public:
  DelayedFit(const DelayedState& state, const AuxiliaryStates& states, const StateEstimate& x)
      : state_(state),
        states_(states),
        x_(x),
        position_covariance_(x.covariance().matrix().block<3, 3>(body::kPosition, body::kPosition)),
        initial_(state.declared.size),
        prior_information_(1.0 / (state.declared.sigma * state.declared.sigma)) {
    std::copy_n(state.declared.initial.begin(), initial_.size(), initial_.data());
  }

  /// (E4) and, if it is so, (E3).
  bool solve(DelayedStart* out) const {
    Minima minima;
    (void)minima.push_back(minimum(initial_));
    add_minima_around(initial_, &minima);
    add_minima_around(best_of(minima).a, &minima);  // its mirror images
    const Minimum& best = best_of(minima);
    Matrix H;
    Vector g;
    linearise(best.a, truncated, &H, &g);
    const bool one = std::none_of(minima.begin(), minima.end(), [&](const Minimum& other) {
      const Vector d = other.a - best.a;
      return other.cost - best.cost < 2.0 * kBound && d.dot(H * d) > kBound;
    });
    if (!one || !is_linear(best.a, H) || share_that_fits(best.a) < 0.8) return false;
    start(best.a, H, out);
    return true;
  }

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
  static Loss huber(double squared) {
    if (squared < kBound) return {squared, 1.0};
    const double r = std::sqrt(squared);
    return {6.0 * r - kBound, 3.0 / r};
  }
  static Loss truncated(double squared) {
    if (squared < kBound) return {squared, 1.0};
    return {kBound, 0.0};
  }

  struct Minimum {
    Vector a;
    double cost = 0.0;
  };
  using Minima = StaticVector<Minimum, 4 * static_cast<std::size_t>(DelayedStart::kMax) + 1>;

  /// f(row) of all measurements, in their order.
  template <class F>
  void for_each_row(const Vector& a, const F& f) const {
    constexpr double kOutside = 10.0;
    AuxiliaryValues values = x_.estimate().auxiliary;
    values.segment(state_.first, a.size()) = a;
    AidingMeasurement::Rows rows;
    Row row;
    for (const HeldMeasurement& held : state_.held) {
      AidedState then = held.then;
      then.states = &states_;
      then.auxiliary = &values;
      row = {kOutside, Vector::Zero(a.size()), decltype(row.Jx)::Zero(), 1.0, &held};
      if (!held.z.evaluate(then, {0, -1, -1, 0}, &rows)) {
        for (int i = 0; i < held.z.rows(); ++i) f(row);
        continue;
      }
      int at = AidingMeasurement::kBody;
      for (const auto& segment : rows.segments) {
        if (segment.column == state_.first) break;
        at += segment.length;
      }
      const Matrix3d drift = position_covariance_ - held.position_covariance;
      for (int i = 0; i < rows.count; ++i) {
        row.residual = rows.r[i];
        row.Ja = rows.J.row(i).segment(at, a.size()).transpose();
        row.Jx = rows.J.row(i).head<AidingMeasurement::kBody>();
        const auto Jp = row.Jx.segment<3>(body::kPosition);
        row.variance = 1.0 + std::max(0.0, (Jp * drift).dot(Jp));  // (E2)
        f(row);
      }
    }
  }

  double cost(const Vector& a, LossFunction loss) const {
    double sum = prior_information_ * (a - initial_).squaredNorm();
    for_each_row(a, [&](const Row& row) { sum += loss(row.squared()).value; });
    return sum;
  }

  /// Information and gradient of half the cost; returns the cost.
  double linearise(const Vector& a, LossFunction loss, Matrix* H, Vector* g) const {
    *H = prior_information_ * Matrix::Identity(a.size(), a.size());
    *g = prior_information_ * (a - initial_);
    double sum = g->dot(a - initial_);
    for_each_row(a, [&](const Row& row) {
      const Loss rho = loss(row.squared());
      *H += rho.weight / row.variance * row.Ja * row.Ja.transpose();
      *g -= rho.weight / row.variance * row.residual * row.Ja;
      sum += rho.value;
    });
    return sum;
  }

  Minimum descend(Vector a, LossFunction loss) const {
    constexpr int kSteps = 30;
    Matrix H;
    Vector g;
    double damping = 1e-3;
    double current = linearise(a, loss, &H, &g);
    for (int i = 0; i < kSteps; ++i) {
      Matrix damped = H;
      damped.diagonal() *= 1.0 + damping;
      const Vector step = damped.ldlt().solve(-g);
      const double next = cost(a + step, loss);
      if (!(next < current)) {
        damping *= 10.0;
        if (damping > 1e6) break;
        continue;
      }
      a += step;
      damping = std::max(1e-9, 0.1 * damping);
      const bool converged = current - next < 1e-3 && damping < 1e-2;
      current = linearise(a, loss, &H, &g);
      if (converged) break;
    }
    return {a, current};
  }

  /// The minimum reached from a: with Huber's loss, which leads there despite outliers, then with
  /// the truncated one, which outliers do not bias.
  Minimum minimum(const Vector& a) const { return descend(descend(a, huber).a, truncated); }
  /// Those reached from a +- sigma_0 along each axis.
  void add_minima_around(const Vector& a, Minima* minima) const {
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      for (const double step : {-state_.declared.sigma, state_.declared.sigma}) {
        (void)minima->push_back(minimum(a + step * Vector::Unit(a.size(), i)));
      }
    }
  }

  static const Minimum& best_of(const Minima& minima) {
    return *std::min_element(minima.begin(), minima.end(),
                             [](const Minimum& a, const Minimum& b) { return a.cost < b.cost; });
  }

  /// What the linearised rows miss at 3 sigma is below their noise, RMS.
  bool is_linear(const Vector& a, const Matrix& H) const {
    const Eigen::LLT<Matrix> L(H);
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      Vector step = 3.0 * Vector::Unit(a.size(), i);
      L.matrixU().solveInPlace(step);
      if (!(missed(a, step) < 1.0) || !(missed(a, -step) < 1.0)) return false;
    }
    return true;
  }

  double missed(const Vector& a, const Vector& step) const {
    StaticVector<double, DelayedState::kMostHeld * AidingMeasurement::kMaxRows> linear;
    for_each_row(a,
                 [&](const Row& row) { (void)linear.push_back(row.residual - row.Ja.dot(step)); });
    double sum = 0.0;
    std::size_t i = 0;
    for_each_row(a + step, [&](const Row& row) {
      const double miss = row.residual - linear[i++];
      sum += miss * miss / row.variance;
    });
    return std::sqrt(sum / static_cast<double>(i));
  }

  double share_that_fits(const Vector& a) const {
    double rows = 0.0;
    double fit = 0.0;
    for_each_row(a, [&](const Row& row) {
      rows += 1.0;
      fit += row.squared() < kBound ? 1.0 : 0.0;
    });
    return rows > 0.0 ? fit / rows : 0.0;
  }

  /// (E3)
  void start(const Vector& a, const Matrix& H, DelayedStart* out) const {
    const Eigen::Index n = a.size();
    out->first = state_.first;
    out->value = a;
    out->by_body = DelayedStart::ByBody::Zero(n, body::kSize);
    Matrix noise = prior_information_ * Matrix::Identity(n, n);
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, DelayedStart::kMax, 3> S(n, 3);
    S.setZero();
    const HeldMeasurement* last = nullptr;
    const auto add_drift = [&](const Matrix3d& until) {
      const Vector3d Q = (until - last->position_covariance).diagonal().cwiseMax(0.0);
      for (int i = 0; i < 3; ++i) noise += Q[i] * S.col(i) * S.col(i).transpose();
    };
    const RigidPose now = x_.estimate().T_WB();
    for_each_row(a, [&](const Row& row) {
      if (last != nullptr && last != row.of) add_drift(row.of->position_covariance);
      last = row.of;
      if (row.squared() >= kBound) return;
      const Vector weighted = row.Ja / row.variance;
      out->by_body -= weighted * (row.Jx * displaced(row.of->then, now));
      noise += weighted * weighted.transpose();
      S += weighted * row.Jx.segment<3>(body::kPosition);
    });
    add_drift(position_covariance_);
    const Matrix inverse = H.ldlt().solve(Matrix(Matrix::Identity(n, n)));
    out->by_body = (inverse * out->by_body).eval();
    out->noise = inverse * noise * inverse;
  }

  const DelayedState& state_;
  const AuxiliaryStates& states_;
  const StateEstimate& x_;
  Matrix3d position_covariance_;  ///< now
  Vector initial_;
  double prior_information_;
};

}  // namespace

bool DelayedStarts::fit(const DelayedState& state, const StateEstimate& x) {
  return DelayedFit(state, states_, x).solve(&start_);
}

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/delayed_start.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "rio/core/so3.hpp"

namespace rio {

namespace {

constexpr Time kBetween = std::chrono::seconds(1);  // tries
constexpr std::size_t kFewest = 20;  // with fewer, a wrong place can explain an outlier, too
constexpr double kThreeSigma = 9.0;

/// rho(r^2) of (E1), and its derivative.
struct Loss {
  double value = 0.0;
  double weight = 0.0;
};
Loss huber(double r2) {
  if (r2 < kThreeSigma) return {r2, 1.0};
  const double r = std::sqrt(r2);
  return {6.0 * r - kThreeSigma, 3.0 / r};
}
Loss truncated(double r2) {
  if (r2 < kThreeSigma) return {r2, 1.0};
  return {kThreeSigma, 0.0};
}

/// G of (E3): the error of a state before by that of the state now, as a rigid body.
Eigen::Matrix<double, AidingMeasurement::kBody, body::kSize> rigid(const AidedState& then,
                                                                   const RigidPose& now) {
  Eigen::Matrix<double, AidingMeasurement::kBody, body::kSize> G;
  G.setZero();
  G.diagonal().setOnes();
  G.block<3, 3>(body::kAttitude, body::kAttitude) = then.T_WB.R.transpose() * now.R;
  G.block<3, 3>(body::kPosition, body::kAttitude) = -skew(then.T_WB.p - now.p) * now.R;
  G.block<3, 3>(body::kVelocity, body::kAttitude) = -skew(then.v_WB) * now.R;
  return G;
}

}  // namespace

/// (E1) for one state.
class DelayedStarts::Problem {
 public:
  using Vector = DelayedStart::Vector;
  using Matrix = DelayedStart::Matrix;
  struct Minimum {
    Vector a;
    double cost = 0.0;
  };
  using Minima = StaticVector<Minimum, 4 * static_cast<std::size_t>(DelayedStart::kMax) + 1>;

  Problem(const Waiting& waiting, const AuxiliaryStates& states, const StateEstimate& x)
      : waiting_(waiting),
        states_(states),
        x_(x),
        position_covariance_(x.covariance().matrix().block<3, 3>(body::kPosition, body::kPosition)),
        initial_(waiting.state.size) {
    std::copy_n(waiting.state.initial.begin(), initial_.size(), initial_.data());
  }

  /// (E4) and, if it is so, (E3).
  bool solve(DelayedStart* out) const {
    Minima minima;
    (void)minima.push_back(minimum(initial_));
    add_minima_around(initial_, &minima);
    add_minima_around(best_of(minima).a, &minima);  // those that are like it
    const Minimum& best = best_of(minima);
    Matrix H;
    Vector g;
    linearise(best.a, truncated, &H, &g);
    const bool one = std::none_of(minima.begin(), minima.end(), [&](const Minimum& other) {
      const Vector d = other.a - best.a;
      return other.cost - best.cost < 2.0 * kThreeSigma && d.dot(H * d) > kThreeSigma;
    });
    if (!one || !is_linear(best.a, H) || share_that_fits(best.a) < 0.8) return false;
    start(best.a, H, out);
    return true;
  }

 private:
  /// f(r, its derivative in the state, in the body state of its time, variance) of every row, or
  /// with r = 10 sigma where the model has no value. rows: J dx + n.
  template <class F>
  void for_each_row(const Vector& a, F&& f) const {
    AuxiliaryValues values = x_.estimate().auxiliary;
    values.segment(waiting_.first, a.size()) = a;
    for (const Held& held : waiting_.held) {
      AidedState then = held.then;
      then.states = &states_;
      then.auxiliary = &values;
      AidingMeasurement::Rows rows;
      if (!held.z.evaluate(then, {0, -1, -1, 0}, &rows)) {
        constexpr double kOutside = 10.0;
        for (int i = 0; i < held.z.rows(); ++i) {
          f(kOutside, Vector(Vector::Zero(a.size())), held, BodyRow(BodyRow::Zero()), 1.0);
        }
        continue;
      }
      int at = AidingMeasurement::kBody;
      for (const auto& segment : rows.segments) {
        if (segment.column == waiting_.first) break;
        at += segment.length;
      }
      const Matrix3d drift = position_covariance_ - held.position_covariance;
      for (int i = 0; i < rows.count; ++i) {
        const Vector3d Jp = rows.J.row(i).segment<3>(body::kPosition).transpose();
        f(rows.r[i], Vector(rows.J.row(i).segment(at, a.size()).transpose()), held,
          BodyRow(rows.J.row(i).head<AidingMeasurement::kBody>()),
          1.0 + std::max(0.0, Jp.dot(drift * Jp)));  // (E2)
      }
    }
  }
  using BodyRow = Eigen::Matrix<double, 1, AidingMeasurement::kBody>;

  double prior_information() const { return 1.0 / (waiting_.state.sigma * waiting_.state.sigma); }

  double cost(const Vector& a, Loss (*loss)(double)) const {
    double sum = prior_information() * (a - initial_).squaredNorm();
    for_each_row(a, [&](double r, const Vector&, const Held&, const BodyRow&, double variance) {
      sum += loss(r * r / variance).value;
    });
    return sum;
  }

  /// Information and gradient of half the cost; returns the cost.
  double linearise(const Vector& a, Loss (*loss)(double), Matrix* H, Vector* g) const {
    const Eigen::Index n = a.size();
    *H = prior_information() * Matrix::Identity(n, n);
    *g = prior_information() * (a - initial_);
    double sum = g->dot(a - initial_);
    for_each_row(a, [&](double r, const Vector& J, const Held&, const BodyRow&, double variance) {
      const Loss rho = loss(r * r / variance);
      *H += rho.weight / variance * J * J.transpose();
      *g -= rho.weight / variance * r * J;
      sum += rho.value;
    });
    return sum;
  }

  static const Minimum& best_of(const Minima& minima) {
    return *std::min_element(minima.begin(), minima.end(),
                             [](const Minimum& a, const Minimum& b) { return a.cost < b.cost; });
  }

  /// Those reached from a +- sigma_0 along each axis.
  void add_minima_around(const Vector& a, Minima* minima) const {
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      for (const double step : {-waiting_.state.sigma, waiting_.state.sigma}) {
        (void)minima->push_back(minimum(a + step * Vector::Unit(a.size(), i)));
      }
    }
  }

  /// The one reached from a: outliers must not keep the way from being found, nor move its end.
  Minimum minimum(const Vector& a) const { return descend(descend(a, huber).a, truncated); }

  Minimum descend(Vector a, Loss (*loss)(double)) const {
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
      const bool converged = current - next < 1e-3;
      current = linearise(a, loss, &H, &g);
      if (converged) break;
    }
    return {a, current};
  }

  /// What the linearised rows miss at 3 sigma, RMS over rows, is below their noise.
  bool is_linear(const Vector& a, const Matrix& H) const {
    const Eigen::LLT<Matrix> L(H);
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      Vector step = 3.0 * Vector::Unit(a.size(), i);
      L.matrixU().solveInPlace(step);
      for (const double sign : {-1.0, 1.0}) {
        if (!(missed(a, sign * step) < 1.0)) return false;
      }
    }
    return true;
  }
  double missed(const Vector& a, const Vector& step) const {
    StaticVector<double, kMostHeld * AidingMeasurement::kMaxRows> linear;
    for_each_row(a, [&](double r, const Vector& J, const Held&, const BodyRow&, double) {
      (void)linear.push_back(r - J.dot(step));
    });
    double sum = 0.0;
    std::size_t i = 0;
    for_each_row(a + step, [&](double r, const Vector&, const Held&, const BodyRow&, double v) {
      sum += (r - linear[i]) * (r - linear[i]) / v;
      ++i;
    });
    return std::sqrt(sum / static_cast<double>(i));
  }

  double share_that_fits(const Vector& a) const {
    double rows = 0.0;
    double fit = 0.0;
    for_each_row(a, [&](double r, const Vector&, const Held&, const BodyRow&, double variance) {
      rows += 1.0;
      if (r * r < kThreeSigma * variance) fit += 1.0;
    });
    return rows > 0.0 ? fit / rows : 0.0;
  }

  void start(const Vector& a, const Matrix& H, DelayedStart* out) const {  // (E3)
    const Eigen::Index n = a.size();
    out->first = waiting_.first;
    out->value = a;
    out->noise = H.ldlt().solve(Matrix(Matrix::Identity(n, n)));
    out->by_body = DelayedStart::ByBody::Zero(n, body::kSize);
    const RigidPose now = x_.estimate().T_WB();
    for_each_row(
        a, [&](double r, const Vector& Ja, const Held& held, const BodyRow& Jx, double variance) {
          if (r * r >= kThreeSigma * variance) return;
          out->by_body -= Ja / variance * (Jx * rigid(held.then, now));
        });
    out->by_body = (out->noise * out->by_body).eval();
    Vector3d drift = Vector3d::Zero();
    for (const Held& held : waiting_.held) {
      drift += (position_covariance_ - held.position_covariance).diagonal().cwiseMax(0.0);
    }
    drift /= static_cast<double>(waiting_.held.size());
    const auto by_position = out->by_body.middleCols<3>(body::kPosition);
    for (int i = 0; i < 3; ++i) {
      out->noise += drift[i] * by_position.col(i) * by_position.col(i).transpose();
    }
  }

  const Waiting& waiting_;
  const AuxiliaryStates& states_;
  const StateEstimate& x_;
  const Matrix3d position_covariance_;
  Vector initial_;
};

DelayedStarts::DelayedStarts(const Options& options)
    : states_(options.auxiliary), gravity_(options.imu.gravity) {
  int first = 0;
  for (const AuxiliaryState& state : states_) {
    if (state.delayed) {
      waiting_.push_back({});
      waiting_.back().state = state;
      waiting_.back().first = first;
    }
    first += state.size;
  }
  for (Waiting& waiting : waiting_) waiting.held.reserve(kMostHeld);
}

void DelayedStarts::reset() {
  for (Waiting& waiting : waiting_) {
    waiting.waits = true;
    waiting.interval = Time{0};
    waiting.held.clear();
  }
}

bool DelayedStarts::any() const {
  return std::any_of(waiting_.begin(), waiting_.end(), [](const Waiting& w) { return w.waits; });
}

bool DelayedStarts::waits(int first) const {
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [first](const Waiting& w) { return w.waits && w.first == first; });
}

bool DelayedStarts::hold(const AidingObservation& seen, const StateEstimate& x) {
  const AidingMeasurement& z = seen.measurement;
  for (Waiting& waiting : waiting_) {
    if (!waiting.waits || !z.depends_on(states_, waiting.first)) continue;
    std::vector<Held>& held = waiting.held;
    if (!held.empty() && z.time() < held.back().z.time() + waiting.interval) return true;
    if (held.empty()) waiting.next_try = z.time() + kBetween;
    if (held.size() == kMostHeld) thin_out(&waiting);
    held.push_back({z, aided_state(z, seen.to_now, x.estimate().nav, x.estimate(), gravity_),
                    x.covariance().matrix().block<3, 3>(body::kPosition, body::kPosition)});
    return true;
  }
  return false;
}

void DelayedStarts::thin_out(Waiting* waiting) {
  std::vector<Held>& held = waiting->held;
  for (std::size_t i = 0; i < held.size() / 2; ++i) held[i] = held[2 * i];
  held.erase(held.begin() + static_cast<std::ptrdiff_t>(held.size() / 2), held.end());
  waiting->interval = (held.back().z.time() - held.front().z.time()) / (held.size() - 1);
}

const DelayedStart* DelayedStarts::determine(const StateEstimate& x) {
  for (Waiting& waiting : waiting_) {
    if (!waiting.waits || waiting.held.empty()) continue;
    const Time newest = waiting.held.back().z.time();
    if (newest < waiting.next_try || waiting.held.size() < kFewest) continue;
    waiting.next_try = newest + kBetween;
    if (!Problem(waiting, states_, x).solve(&start_)) continue;
    waiting.waits = false;
    waiting.held.clear();
    return &start_;
  }
  return nullptr;
}

}  // namespace rio

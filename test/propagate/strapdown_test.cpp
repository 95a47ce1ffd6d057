// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/strapdown.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "support/constants.hpp"
#include "support/random_state.hpp"
#include "support/strapdown_case.hpp"

namespace rio {
namespace {

using test::kGravity;

// Attitude, velocity and position of dq/dt = q w / 2, dv/dt = R a + g, dp/dt = v.
struct Motion {
  Eigen::Vector4d q;  // x y z w
  Vector3d v;
  Vector3d p;
};
Motion operator+(const Motion& a, const Motion& b) {
  return {a.q + b.q, a.v + b.v, a.p + b.p};
}
Motion operator*(double s, const Motion& a) {
  return {s * a.q, s * a.v, s * a.p};
}

Motion slope(const Motion& x, const Vector3d& w, const Vector3d& a) {
  const Quaternion q(x.q);
  const Quaternion rate = q * Quaternion(0.0, w.x(), w.y(), w.z());
  return {0.5 * rate.coeffs(), q.normalized() * a - kGravity * Vector3d::UnitZ(), x.v};
}

// Runge-Kutta, fourth order, 1e5 substeps.
NavState integrate_reference(const Vector3d& gyro, const Vector3d& accel, double dt, NavState x) {
  const Vector3d w = gyro - x.gyro_bias;
  const Vector3d a = accel - x.accel_bias;
  constexpr int kSubsteps = 100000;
  const double h = dt / kSubsteps;
  Motion m{x.q_WB.coeffs(), x.v_WB, x.p_WB};
  for (int i = 0; i < kSubsteps; ++i) {
    const Motion k1 = slope(m, w, a);
    const Motion k2 = slope(m + 0.5 * h * k1, w, a);
    const Motion k3 = slope(m + 0.5 * h * k2, w, a);
    const Motion k4 = slope(m + h * k3, w, a);
    m = m + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  x.q_WB = Quaternion(m.q).normalized();
  x.v_WB = m.v;
  x.p_WB = m.p;
  return x;
}

using Case = test::StrapdownCase;

TEST(Strapdown, IntegrateEqualsRungeKutta) {
  for (const Case& c : test::strapdown_cases(4, 1.5)) {
    for (const double dt : test::kStrapdownSteps) {
      NavState x = c.state;
      integrate(c.gyro, c.accel, dt, kGravity, x);
      // 1e5 additions to positions of some 10 m
      const test::BodyVector e =
          test::error_of(integrate_reference(c.gyro, c.accel, dt, c.state), x);
      EXPECT_LT(e.cwiseAbs().maxCoeff(), 1e-10) << dt;
    }
  }
}

TEST(Strapdown, IntegrateOverAStepSetsTheStamp) {
  const Case c = test::strapdown_cases(4, 1.5).back();
  const ImuStep step{Time(7'000'000'000), Time(7'066'000'000), c.gyro, c.accel, false};
  NavState x = c.state;
  integrate(step, kGravity, x);
  NavState expected = c.state;
  integrate(c.gyro, c.accel, 0.066, kGravity, expected);
  EXPECT_EQ(x.time, step.end);
  EXPECT_LT(test::error_of(expected, x).norm(), 1e-14);
}

TEST(Strapdown, TransitionIsTheDerivativeOfIntegrate) {
  constexpr double h = 1e-3;  // five points: h^4/30 of truncation, 1e-12 of rounding
  for (const Case& c : test::strapdown_cases(4, 1.5)) {
    for (const double dt : test::kStrapdownSteps) {
      NavState nominal = c.state;
      integrate(c.gyro, c.accel, dt, kGravity, nominal);
      Matrix15d expected;
      for (int column = 0; column < body::kSize; ++column) {
        const auto error = [&](double step) {
          NavState x = test::perturbed(c.state, step * test::BodyVector::Unit(column));
          integrate(c.gyro, c.accel, dt, kGravity, x);
          return test::error_of(x, nominal);
        };
        expected.col(column) =
            (8.0 * (error(h) - error(-h)) - error(2 * h) + error(-2 * h)) / (12 * h);
      }
      const Matrix15d actual = transition(c.rotation(), c.w(), c.a(), dt);
      for (int column = 0; column < body::kSize; ++column) {
        EXPECT_LT((actual - expected).col(column).cwiseAbs().maxCoeff(), 2e-11)
            << "column " << column << " dt " << dt;
      }
    }
  }
}

TEST(Strapdown, TransitionsCompose) {
  for (const Case& c : test::strapdown_cases(4, 1.5)) {
    const double first = 0.3;
    const double second = 0.45;
    NavState middle = c.state;
    integrate(c.gyro, c.accel, first, kGravity, middle);
    const Matrix15d chain = transition(middle.q_WB.toRotationMatrix(), c.w(), c.a(), second) *
                            transition(c.rotation(), c.w(), c.a(), first);
    const Matrix15d whole = transition(c.rotation(), c.w(), c.a(), first + second);
    EXPECT_LT((chain - whole).cwiseAbs().maxCoeff(), 1e-13);
  }
}

}  // namespace
}  // namespace rio

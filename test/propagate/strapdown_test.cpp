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

// Runge-Kutta, fourth order, 1e5 substeps, of dq/dt = q w / 2, dv/dt = R a + g, dp/dt = v.
NavState integrate_reference(const Vector3d& gyro, const Vector3d& accel, double dt, NavState x) {
  using Vector10d = Eigen::Matrix<double, 10, 1>;  // q xyzw, v, p
  const Vector3d w = gyro - x.gyro_bias;
  const Vector3d a = accel - x.accel_bias;
  const auto slope = [&](const Vector10d& m) {
    const Quaternion q(m.head<4>());
    Vector10d rate;
    rate << 0.5 * (q * Quaternion(0.0, w.x(), w.y(), w.z())).coeffs(),
        q.normalized() * a - kGravity * Vector3d::UnitZ(), m.segment<3>(4);
    return rate;
  };
  constexpr int kSubsteps = 100000;
  const double h = dt / kSubsteps;
  Vector10d m;
  m << x.q_WB.coeffs(), x.v_WB, x.p_WB;
  for (int i = 0; i < kSubsteps; ++i) {
    const Vector10d k1 = slope(m);
    const Vector10d k2 = slope(m + 0.5 * h * k1);
    const Vector10d k3 = slope(m + 0.5 * h * k2);
    const Vector10d k4 = slope(m + h * k3);
    m += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  x.q_WB = Quaternion(m.head<4>()).normalized();
  x.v_WB = m.segment<3>(4);
  x.p_WB = m.tail<3>();
  return x;
}

using Case = test::StrapdownCase;

TEST(Strapdown, IntegrateEqualsRungeKutta) {
  for (const Case& c : test::strapdown_cases(4, 1.5)) {
    for (const double dt : test::kStrapdownSteps) {
      const ImuStep step{Time(7'000'000'000), Time(7'000'000'000) + from_seconds(dt), c.gyro,
                         c.accel};
      NavState x = c.state;
      integrate(step, kGravity, x);
      EXPECT_EQ(x.time, step.end);
      // 1e5 additions to positions of some 10 m
      const test::BodyVector e =
          test::error_of(integrate_reference(c.gyro, c.accel, dt, c.state), x);
      EXPECT_LT(e.cwiseAbs().maxCoeff(), 1e-10) << dt;
    }
  }
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
      const Matrix15d actual = BodyTransition(c.rotation(), c.w(), c.a(), dt).matrix();
      for (int column = 0; column < body::kSize; ++column) {
        EXPECT_LT((actual - expected).col(column).cwiseAbs().maxCoeff(), 2e-11)
            << "column " << column << " dt " << dt;
      }
    }
  }
}

}  // namespace
}  // namespace rio

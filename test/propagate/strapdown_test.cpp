// SPDX-License-Identifier: BSD-3-Clause
// Strapdown integration against Runge-Kutta, its transition against differences, its noise against
// quadrature, and what accumulates over many steps.
#include "rio/propagate/strapdown.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "rio/propagate/predictor.hpp"
#include "support/constants.hpp"
#include "support/strapdown_case.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

using Case = StrapdownCase;

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

TEST(Strapdown, IntegrateEqualsRungeKutta) {
  for (const Case& c : strapdown_cases(4, 1.5)) {
    for (const double dt : kStrapdownSteps) {
      const ImuStep step{Time(7'000'000'000), Time(7'000'000'000) + from_seconds(dt), c.gyro,
                         c.accel};
      NavState x = c.state;
      integrate(step, kGravity, x);
      EXPECT_EQ(x.time, step.end);
      // 1e5 additions to positions of some 10 m
      const BodyVector e = error_of(integrate_reference(c.gyro, c.accel, dt, c.state), x);
      EXPECT_LT(e.cwiseAbs().maxCoeff(), 1e-10) << dt;
    }
  }
}

TEST(Strapdown, TransitionIsTheDerivativeOfIntegrate) {
  constexpr double h = 1e-3;  // five points: h^4/30 of truncation, 1e-12 of rounding
  for (const Case& c : strapdown_cases(4, 1.5)) {
    for (const double dt : kStrapdownSteps) {
      NavState nominal = c.state;
      integrate(c.gyro, c.accel, dt, kGravity, nominal);
      Matrix15d expected;
      for (int column = 0; column < body::kSize; ++column) {
        const auto error = [&](double step) {
          NavState x = perturbed(c.state, step * BodyVector::Unit(column));
          integrate(c.gyro, c.accel, dt, kGravity, x);
          return error_of(x, nominal);
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

/// The densities, each moved to the end of the step by the transition, integrated by Simpson.
Matrix15d noise_reference(const Case& c, double dt, const ProcessNoise& n) {
  constexpr int kIntervals = 400;
  BodyVector density = BodyVector::Zero();
  density.segment<3>(body::kAttitude).setConstant(n.gyro);
  density.segment<3>(body::kVelocity).setConstant(n.accel);
  density.segment<3>(body::kGyroBias).setConstant(n.gyro_walk);
  density.segment<3>(body::kAccelBias).setConstant(n.accel_walk);
  Matrix15d Q = Matrix15d::Zero();
  for (int i = 0; i <= kIntervals; ++i) {
    const double t = dt * i / kIntervals;
    const double simpson = i == 0 || i == kIntervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    const Matrix3d R = c.rotation() * rotation_of(c.w() * t).toRotationMatrix();
    const Matrix15d to_end = BodyTransition(R, c.w(), c.a(), dt - t).matrix();
    Q += simpson * dt / (3.0 * kIntervals) * to_end * density.asDiagonal() * to_end.transpose();
  }
  return Q;
}

TEST(ProcessNoise, IsTheDensityMovedToTheEndOfTheStep) {
  const ProcessNoise usual{1.6e-7, 1.6e-5, 4e-10, 4e-8};
  const ProcessNoise gyro{1e-4, 1e-12, 1e-14, 1e-14};
  const ProcessNoise gyro_walk{1e-14, 1e-14, 1e-4, 1e-14};
  const ProcessNoise accel_walk{1e-14, 1e-14, 1e-14, 1e-4};
  for (const ProcessNoise& n : {usual, gyro, gyro_walk, accel_walk}) {
    const bool walks = n.gyro < 1e-10;
    for (const Case& c : strapdown_cases(3, 1.2)) {
      for (const double dt : kStrapdownSteps) {
        const Matrix15d Q = process_noise_covariance(c.rotation(), c.w(), c.a(), dt, n).matrix();
        EXPECT_LT(relative_difference(Q.transpose(), Q), 1e-15);
        // exact without rotation; steps are cut at 0.05 rad
        const double phi = std::min(0.05, c.w().norm() * dt);
        const double error = walks ? phi / 3.0 : phi * phi / 12.0;
        EXPECT_LT(relative_difference(Q, noise_reference(c, dt, n)), 3e-9 + error) << dt;
      }
    }
  }
}

// A clock that jumps, a gap of hours: the work stays bounded.
TEST(ProcessNoise, OfALongStepCostsNoMore) {
  const ProcessNoise n{1.6e-7, 1.6e-5, 4e-10, 4e-8};
  const Case c = strapdown_cases(1, 1.2).back();
  const auto begin = std::chrono::steady_clock::now();
  const Matrix15d Q = process_noise_covariance(c.rotation(), c.w(), c.a(), 1e7, n).matrix();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(took.count(), 0.5);  // 4e8 parts of 0.05 rad would take minutes
  EXPECT_TRUE(Q.allFinite());
  EXPECT_GE(Q.diagonal().minCoeff(), 0.0);
}

/// A gap in which the body stood: the errors of rate and force are constants of the sigmas given.
TEST(ProcessNoise, InAGapIsThatOfConstantErrors) {
  ImuOptions o;
  o.gyro_noise_density = o.gyro_random_walk = o.accel_noise_density = o.accel_random_walk = 0.0;
  o.gap_rate_sigma = 0.05;
  o.gap_accel_sigma = 2.0;
  constexpr double dt = 0.3;
  ImuBuffer imu(TimingOptions{}, o);
  const Vector3d gravity = kGravity * Vector3d::UnitZ();
  for (const double t : {0.0, dt}) imu.push_back({from_seconds(t), Vector3d::Zero(), gravity});
  Propagation p;
  imu.for_each_step(Time{0}, from_seconds(dt), [&](const ImuStep& step) { p.step(step, o); });
  EXPECT_TRUE(p.gap);
  const BodyVector Q = p.noise().diagonal();
  for (int i = 0; i < 3; ++i) {
    // the tilt that the rate makes moves the velocity by a thousandth; white noise of the same
    // density moves the position by 4/3 as much
    EXPECT_NEAR(Q[body::kAttitude + i], std::pow(0.05 * dt, 2), 1e-9);
    EXPECT_NEAR(Q[body::kVelocity + i] / std::pow(2.0 * dt, 2), 1.0, 0.003);
    EXPECT_NEAR(Q[body::kPosition + i] / std::pow(0.5 * 2.0 * dt * dt, 2), 4.0 / 3.0, 0.003);
  }
  Propagation quiet;
  quiet.step({Time{0}, from_seconds(dt), Vector3d::Zero(), gravity, 0.0}, o);
  EXPECT_TRUE(quiet.noise().isZero());
}

TEST(Propagation, AccumulatesTheProductChain) {
  Random random(4);
  const ImuOptions o;
  Propagation p;
  p.state = random.state();
  NavState x = p.state;
  const BodyCovariance P0 = 1e-4 * BodyCovariance::Identity();
  Matrix15d P = P0;
  for (const ImuStep& step : random_steps(random, 30, 1.0)) {
    const double dt = to_seconds(step.end - step.begin);
    const Matrix3d R = x.q_WB.toRotationMatrix();
    const Vector3d w = step.gyro_B - x.gyro_bias;
    const Vector3d a = step.accel_B - x.accel_bias;
    const Matrix15d phi = BodyTransition(R, w, a, dt).matrix();
    P = (phi * P * phi.transpose() +
         process_noise_covariance(R, w, a, dt, process_noise(o, step)).matrix())
            .eval();
    integrate(step, o.gravity, x);
    p.step(step, o);
  }
  EXPECT_EQ(p.state.time, x.time);
  EXPECT_LT(error_of(x, p.state).norm(), 1e-15);
  const Matrix15d once = p.transition() * P0 * p.transition().transpose() + p.noise();
  EXPECT_LT(relative_difference(once, P), 1e-12);  // 30 products
  EXPECT_LT(relative_difference(p.noise().transpose(), p.noise()), 1e-14);
  EXPECT_TRUE(is_positive_definite(p.noise()));
  EXPECT_FALSE(p.gap);
  EXPECT_TRUE(p.finite());
}

TEST(Propagation, GapCutByScansIsNoLessUncertain) {
  ImuBuffer imu(TimingOptions{}, ImuOptions{});
  for (const double t : {0.0, 1.0})
    imu.push_back({from_seconds(t), Vector3d::Zero(), Vector3d::Zero()});
  const auto noise = [&imu](int pieces) {
    Propagation p;
    for (int i = 1; i <= pieces; ++i) {
      imu.for_each_step(p.state.time, from_seconds(1.0) * i / pieces,
                        [&p](const ImuStep& step) { p.step(step, ImuOptions{}); });
    }
    return p.noise();
  };
  const Matrix15d whole = noise(1);
  const Matrix15d pieces = noise(15);
  for (const int i : {body::kAttitude, body::kVelocity, body::kPosition}) {
    EXPECT_GT(pieces(i, i), 0.99 * whole(i, i)) << i;  // the error is one constant, not 15 draws
  }
}

TEST(Propagation, RemembersAGapAndNoticesNonFiniteData) {
  Random random(5);
  Steps steps = random_steps(random, 3, 1.0);
  steps[1].gap = 0.2;
  Propagation p;
  for (const ImuStep& step : steps) p.step(step, ImuOptions{});
  EXPECT_TRUE(p.gap);
  EXPECT_TRUE(p.finite());
  steps[2].gyro_B.y() = std::numeric_limits<double>::quiet_NaN();
  p.step(steps[2], ImuOptions{});
  EXPECT_FALSE(p.finite());
}

TEST(Predictor, SampleBySampleEqualsAllAtOnce) {
  Random random(6);
  const NavState start = random.state();
  ImuBuffer imu(TimingOptions{}, ImuOptions{});
  Predictor gradual(kGravity);
  gradual.rebase(start, imu);
  for (int i = 0; i < 50; ++i) {
    imu.push_back({Time(5'000'000 * (i - 3)), random.normal_vector(), random.normal_vector(5.0)});
    gradual.advance(imu);
  }
  Predictor at_once(kGravity);
  at_once.rebase(start, imu);
  EXPECT_EQ(gradual.state().time, imu.newest().time);
  EXPECT_EQ(at_once.state().time, imu.newest().time);
  EXPECT_LT(error_of(at_once.state(), gradual.state()).norm(), 1e-14);
}

}  // namespace
}  // namespace rio::test

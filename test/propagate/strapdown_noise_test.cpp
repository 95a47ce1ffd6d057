// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "rio/propagate/strapdown.hpp"
#include "support/constants.hpp"
#include "support/random_state.hpp"
#include "support/strapdown_case.hpp"
#include "support/symmetric.hpp"

namespace rio {
namespace {

using test::kGravity;

using Case = test::StrapdownCase;

double asymmetry(const Matrix15d& Q) {
  const Matrix15d transposed = Q.transpose();
  return test::relative_difference(transposed, Q);
}

/// The densities, each moved to the end of the step by the transition, integrated by Simpson.
Matrix15d noise_reference(const Case& c, double dt, const ProcessNoise& n) {
  constexpr int kIntervals = 400;
  test::BodyVector density = test::BodyVector::Zero();
  density.segment<3>(body::kAttitude).setConstant(n.gyro);
  density.segment<3>(body::kVelocity).setConstant(n.accel);
  density.segment<3>(body::kGyroBias).setConstant(n.gyro_walk);
  density.segment<3>(body::kAccelBias).setConstant(n.accel_walk);
  Matrix15d Q = Matrix15d::Zero();
  for (int i = 0; i <= kIntervals; ++i) {
    const double t = dt * i / kIntervals;
    const double simpson = i == 0 || i == kIntervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    const Matrix3d R = c.rotation() * test::rotation_of(c.w() * t).toRotationMatrix();
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
    for (const Case& c : test::strapdown_cases(3, 1.2)) {
      for (const double dt : test::kStrapdownSteps) {
        const Matrix15d Q = process_noise_covariance(c.rotation(), c.w(), c.a(), dt, n).matrix();
        EXPECT_LT(asymmetry(Q), 1e-15);
        // exact without rotation; steps are cut at 0.05 rad
        const double phi = std::min(0.05, c.w().norm() * dt);
        const double error = walks ? phi / 3.0 : phi * phi / 12.0;
        EXPECT_LT(test::relative_difference(Q, noise_reference(c, dt, n)), 3e-9 + error) << dt;
      }
    }
  }
}

// A clock that jumps, a gap of hours: the work stays bounded.
TEST(ProcessNoise, OfALongStepCostsNoMore) {
  const ProcessNoise n{1.6e-7, 1.6e-5, 4e-10, 4e-8};
  const Case c = test::strapdown_cases(1, 1.2).back();
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
  const test::BodyVector Q = p.noise().diagonal();
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
  test::Random random(4);
  const ImuOptions o;
  Propagation p;
  p.state = random.state();
  NavState x = p.state;
  const BodyCovariance P0 = 1e-4 * BodyCovariance::Identity();
  Matrix15d P = P0;
  for (const ImuStep& step : test::random_steps(random, 30, 1.0)) {
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
  EXPECT_LT(test::error_of(x, p.state).norm(), 1e-15);
  const Matrix15d once = p.transition() * P0 * p.transition().transpose() + p.noise();
  EXPECT_LT(test::relative_difference(once, P), 1e-12);  // 30 products
  EXPECT_LT(asymmetry(p.noise()), 1e-14);
  EXPECT_TRUE(test::is_positive_definite(p.noise()));
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
  test::Random random(5);
  test::Steps steps = test::random_steps(random, 3, 1.0);
  steps[1].gap = 0.2;
  Propagation p;
  for (const ImuStep& step : steps) p.step(step, ImuOptions{});
  EXPECT_TRUE(p.gap);
  EXPECT_TRUE(p.finite());
  steps[2].gyro_B.y() = std::numeric_limits<double>::quiet_NaN();
  p.step(steps[2], ImuOptions{});
  EXPECT_FALSE(p.finite());
}

}  // namespace
}  // namespace rio

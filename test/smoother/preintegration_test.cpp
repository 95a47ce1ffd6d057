// SPDX-License-Identifier: BSD-3-Clause
// Preintegration against strapdown integration step by step and against Monte Carlo.
#include "rio/smoother/preintegration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "rio/smoother/imu_factor.hpp"
#include "support/preintegration_cases.hpp"
#include "support/symmetric.hpp"

namespace rio {
namespace {

using test::kRates;
using test::preintegrate;
using test::random_steps;
using test::relative_difference;
using test::seconds;
using test::Steps;
using test::to_world;
using test::whitened;

TEST(Preintegration, PredictEqualsStrapdown) {
  test::Random random(11);
  const ImuOptions options;
  for (const double rate : kRates) {
    for (int i = 0; i < 10; ++i) {
      NavState from = random.state();
      const Steps steps = random_steps(random, 60, rate);
      from.time = steps.front().begin;
      NavState expected = from;
      for (const ImuStep& step : steps) integrate(step, options.gravity, expected);
      const NavState actual =
          preintegrate(steps, from.gyro_bias, from.accel_bias).predict(from, options.gravity);
      EXPECT_EQ(actual.time, expected.time);
      // 60 additions to some 20 m, rounded at 4e-15 each
      EXPECT_LT(test::error_of(expected, actual).cwiseAbs().maxCoeff(), 2e-13) << rate;
    }
  }
}

TEST(Preintegration, TransitionAndCovarianceEqualPropagation) {
  test::Random random(12);
  const ImuOptions options;
  for (const double rate : kRates) {
    Propagation reference;
    reference.state = random.state();
    const NavState from = reference.state;
    Steps steps = random_steps(random, 60, rate);
    const Preintegration flawless = preintegrate(steps, from.gyro_bias, from.accel_bias);
    EXPECT_FALSE(flawless.gap());
    steps[7].gap = 0.12;
    for (const ImuStep& step : steps) reference.step(step, options);
    const Preintegration imu = preintegrate(steps, from.gyro_bias, from.accel_bias);
    const Matrix15d M = to_world(from.q_WB);
    // the entries of the transition are below 10
    EXPECT_LT((M * imu.transition() * M.transpose() - reference.transition()).cwiseAbs().maxCoeff(),
              1e-13);
    EXPECT_LT(relative_difference(M * imu.covariance() * M.transpose(), reference.noise()), 1e-12);
    EXPECT_TRUE(imu.gap());
    EXPECT_TRUE(imu.finite());
  }
}

// Independent of the noise of strapdown.hpp: samples with white noise, biases that walk.
TEST(Preintegration, CovarianceEqualsMonteCarlo) {
  constexpr int kRuns = 10000;
  ImuOptions options;  // the walks are raised until they matter within the third of a second
  options.gyro_random_walk = 1e-3;
  options.accel_random_walk = 1e-2;
  test::Random random(13);
  const NavState from = random.state();
  const Steps steps = random_steps(random, 30, 1.5);
  const Preintegration imu = preintegrate(steps, from.gyro_bias, from.accel_bias, options);
  const NavState predicted = imu.predict(from, options.gravity);
  Matrix15d sum = Matrix15d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    NavState truth = from;
    const auto walk = [&](double half_step) {
      truth.gyro_bias += random.normal_vector(options.gyro_random_walk * std::sqrt(half_step));
      truth.accel_bias += random.normal_vector(options.accel_random_walk * std::sqrt(half_step));
    };
    for (ImuStep step : steps) {
      const double dt = seconds(step);
      step.gyro_B += random.normal_vector(options.gyro_noise_density / std::sqrt(dt));
      step.accel_B += random.normal_vector(options.accel_noise_density / std::sqrt(dt));
      walk(0.5 * dt);
      integrate(step, options.gravity, truth);
      walk(0.5 * dt);
    }
    const test::BodyVector e = to_world(from.q_WB).transpose() * test::error_of(truth, predicted);
    sum += e * e.transpose();
  }
  // sqrt(2/10000) = 0.014 on the diagonal, 0.01 off it: 5 sigma for 120 entries
  EXPECT_LT((whitened(sum / kRuns, imu.covariance()) - Matrix15d::Identity()).cwiseAbs().maxCoeff(),
            0.07);
}

TEST(Preintegration, BiasCorrectionIsOfFirstOrder) {
  test::Random random(14);
  for (int i = 0; i < 10; ++i) {
    const Vector3d gyro_bias = random.normal_vector(0.02);
    const Vector3d accel_bias = random.normal_vector(0.1);
    const Steps steps = random_steps(random, 60, 1.5);
    const Preintegration imu = preintegrate(steps, gyro_bias, accel_bias);
    const Vector3d dbg = 0.02 * random.direction();
    const Vector3d dba = 0.2 * random.direction();
    const auto error = [&](double scale) {
      const Vector3d bg = gyro_bias + scale * dbg;
      const Vector3d ba = accel_bias + scale * dba;
      const ImuIncrement corrected = imu.corrected(bg, ba);
      const ImuIncrement exact = preintegrate(steps, bg, ba).increment();
      return std::array<double, 3>{corrected.delta_q.angularDistance(exact.delta_q),
                                   (corrected.delta_v - exact.delta_v).norm(),
                                   (corrected.delta_p - exact.delta_p).norm()};
    };
    const std::array<double, 3> whole = error(1.0);
    const std::array<double, 3> half = error(0.5);
    for (std::size_t k = 0; k < whole.size(); ++k) {
      EXPECT_GT(half[k], 1e-9) << k;  // above rounding: there is something to compare
      EXPECT_NEAR(whole[k] / half[k], 4.0, 0.2) << k;  // the third order is 1 % of the second
    }
    const ImuIncrement accel_only = imu.corrected(gyro_bias, accel_bias + dba);
    const ImuIncrement exact = preintegrate(steps, gyro_bias, accel_bias + dba).increment();
    EXPECT_LT((accel_only.delta_v - exact.delta_v).norm(), 1e-14);
    EXPECT_LT((accel_only.delta_p - exact.delta_p).norm(), 1e-14);
  }
}

// What the comment of corrected() promises of its error.
TEST(Preintegration, BiasCorrectionHoldsAsFarAsDocumented) {
  test::Random random(15);
  constexpr double kRate = 1.5;
  constexpr double kForce = 10.0;
  const std::array<std::array<double, 2>, 2> spans = {{{0.1, 0.1}, {1.0, 0.01}}};  // [s], [rad/s]
  for (const auto& [duration, change] : spans) {
    const double square = change * change * std::pow(duration, 3);
    double worst_attitude = 0.0;
    double worst_velocity = 0.0;
    for (int i = 0; i < 100; ++i) {
      const ImuStep step{Time{0}, from_seconds(duration), kRate * random.direction(),
                         kForce * random.direction(), 0.0};
      const Vector3d bias = change * random.direction();
      const Vector3d zero = Vector3d::Zero();
      const ImuIncrement corrected = preintegrate({step}, zero, zero).corrected(bias, zero);
      const ImuIncrement exact = preintegrate({step}, bias, zero).increment();
      worst_attitude = std::max(worst_attitude, corrected.delta_q.angularDistance(exact.delta_q) /
                                                    (kRate * square / 12.0));
      worst_velocity = std::max(
          worst_velocity, (corrected.delta_v - exact.delta_v).norm() / (kForce * square / 6.0));
    }
    // the worst of 100 directions comes near the bound; the third order may exceed it by a
    // hundredth
    EXPECT_GT(worst_attitude, 0.8);
    EXPECT_LT(worst_attitude, 1.01);
    EXPECT_GT(worst_velocity, 0.8);
    EXPECT_LT(worst_velocity, 1.01);
  }
}

TEST(Preintegration, AStepCutInTwoIsTheSame) {
  test::Random random(16);
  for (const double rate : {1e-9, 1.5}) {
    Steps whole = random_steps(random, 20, rate);
    whole[3].gap = 0.2;
    Steps cut;
    for (const ImuStep& step : whole) {
      ImuStep first = step;
      ImuStep second = step;
      first.end = second.begin = step.begin + (step.end - step.begin) / 3;
      cut.push_back(first);
      cut.push_back(second);
    }
    const Vector3d gyro_bias = random.normal_vector(0.02);
    const Vector3d accel_bias = random.normal_vector(0.1);
    const Preintegration a = preintegrate(whole, gyro_bias, accel_bias);
    const Preintegration b = preintegrate(cut, gyro_bias, accel_bias);
    EXPECT_EQ(a.duration(), b.duration());
    EXPECT_LT(a.increment().delta_q.angularDistance(b.increment().delta_q), 1e-14);
    EXPECT_LT((a.increment().delta_v - b.increment().delta_v).norm(), 1e-14);
    EXPECT_LT((a.increment().delta_p - b.increment().delta_p).norm(), 1e-14);
    EXPECT_LT((a.transition() - b.transition()).cwiseAbs().maxCoeff(), 1e-14);
    // sums of 40 terms, and the noise of a step that turns (strapdown.hpp)
    double phi = 0.0;
    for (const ImuStep& step : whole) {
      const double dt = to_seconds(step.end - step.begin);
      phi = std::max(phi, dt * (step.gyro_B - gyro_bias).norm());
    }
    EXPECT_LT(relative_difference(b.covariance(), a.covariance()), 1e-13 + phi * phi / 12.0);
  }
}

TEST(Preintegration, ResetForgetsAndNonFiniteDataAreNoticed) {
  test::Random random(17);
  Steps steps = random_steps(random, 5, 1.5);
  steps[2].gap = 0.3;
  Preintegration imu = preintegrate(steps, Vector3d(1, 2, 3), Vector3d(4, 5, 6));
  EXPECT_EQ(imu.gyro_bias(), Vector3d(1, 2, 3));
  EXPECT_EQ(imu.accel_bias(), Vector3d(4, 5, 6));
  imu.reset(Vector3d::Zero(), Vector3d::Zero());
  EXPECT_EQ(imu.duration(), Time{0});
  EXPECT_FALSE(imu.gap());
  EXPECT_FALSE(ImuFactor(imu, 9.81).valid());  // no step, no covariance
  EXPECT_FALSE(ImuFactor().valid());
  const NavState from = random.state();
  EXPECT_LT(test::error_of(from, imu.predict(from, 9.81)).norm(), 1e-15);
  steps[4].accel_B.z() = std::numeric_limits<double>::quiet_NaN();
  imu = preintegrate(steps, Vector3d::Zero(), Vector3d::Zero());
  EXPECT_FALSE(imu.finite());
  EXPECT_FALSE(ImuFactor(imu, 9.81).valid());
}

// Every combination of noise densities set to zero, from one sample to a second.

}  // namespace
}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Preintegration against strapdown integration step by step, whose noise is held against Monte
// Carlo in strapdown_noise_test.cpp.
#include "rio/smoother/preintegration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "rio/smoother/imu_factor.hpp"
#include "support/preintegration_cases.hpp"

namespace rio {
namespace {

using test::kRates;
using test::predict;
using test::preintegrate;
using test::random_steps;
using test::relative_difference;
using test::Steps;
using test::to_world;

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
          predict(preintegrate(steps, from.gyro_bias, from.accel_bias), from, options.gravity);
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
  EXPECT_LT(test::error_of(from, predict(imu, from, 9.81)).norm(), 1e-15);
  steps[4].accel_B.z() = std::numeric_limits<double>::quiet_NaN();
  imu = preintegrate(steps, Vector3d::Zero(), Vector3d::Zero());
  EXPECT_FALSE(imu.finite());
  EXPECT_FALSE(ImuFactor(imu, 9.81).valid());
}

}  // namespace
}  // namespace rio

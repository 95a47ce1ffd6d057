// SPDX-License-Identifier: BSD-3-Clause
// The factor between two states against central differences, and its statistics.
#include "rio/smoother/imu_factor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support/preintegration_cases.hpp"
#include "support/symmetric.hpp"

namespace rio {
namespace {

using test::kRates;
using test::predict;
using test::preintegrate;
using test::random_steps;
using test::Steps;
using test::to_world;
using test::whitened;

// Every combination of noise densities set to zero, from one sample to a second.
TEST(ImuFactor, IsRegularWithoutNoise) {
  test::Random random(18);
  for (unsigned zeros = 0; zeros < 16; ++zeros) {
    ImuOptions options;
    if ((zeros & 1U) != 0) options.gyro_noise_density = 0.0;
    if ((zeros & 2U) != 0) options.gyro_random_walk = 0.0;
    if ((zeros & 4U) != 0) options.accel_noise_density = 0.0;
    if ((zeros & 8U) != 0) options.accel_random_walk = 0.0;
    for (const int count : {1, 10, 100}) {
      for (const double rate : {1e-9, 1.5}) {
        Steps steps = random_steps(random, count, rate);
        steps.front().end = steps.front().begin + from_seconds(0.005);
        const Preintegration imu = preintegrate(steps, Vector3d::Zero(), Vector3d::Zero(), options);
        EXPECT_TRUE(ImuFactor(imu, 9.81).valid());
        const Matrix15d S = imu.covariance();
        const Matrix15d I = Matrix15d::Identity();
        EXPECT_LT((whitened(S, S) - I).cwiseAbs().maxCoeff(), 1e-12) << zeros << ' ' << count;
        EXPECT_LT(test::solve(S, I).diagonal().maxCoeff(), 1e17);
      }
    }
  }
}

// The floor changes nothing for a sensor that is worse than it.
TEST(ImuFactor, FloorLeavesTheDefaultsAlone) {
  const ImuOptions o;
  EXPECT_GT(o.gyro_noise_density, 10.0 * imu_floor::kGyroNoise);
  EXPECT_GT(o.gyro_random_walk, 10.0 * imu_floor::kGyroWalk);
  EXPECT_GT(o.accel_noise_density, 10.0 * imu_floor::kAccelNoise);
  EXPECT_GT(o.accel_random_walk, 10.0 * imu_floor::kAccelWalk);
}

struct Pair {
  ImuFactor factor;
  NavState xi;
  NavState xj;
};

// A factor and states whose residual is of the given size [rad, m, m/s]; x_i has other biases than
// those preintegrated with.
Pair random_pair(test::Random& random, double rate, double attitude, double motion) {
  Pair out;
  out.xi = random.state();
  const Vector3d gyro_bias = out.xi.gyro_bias + random.normal_vector(0.05);
  const Vector3d accel_bias = out.xi.accel_bias + random.normal_vector(0.2);
  const Preintegration imu = preintegrate(random_steps(random, 20, rate), gyro_bias, accel_bias);
  out.factor = ImuFactor(imu, 9.81);
  test::BodyVector e;
  e << attitude * random.direction(), random.normal_vector(motion), random.normal_vector(motion),
      random.normal_vector(0.1 * motion), random.normal_vector(motion);
  out.xj = test::perturbed(predict(imu, out.xi, 9.81), e);
  return out;
}

ImuFactor::Residual residual(const ImuFactor& factor, const NavState& xi, const NavState& xj) {
  ImuFactor::Residual r;
  factor.evaluate_unwhitened(xi, xj, &r, nullptr);
  return r;
}

void expect_jacobian_of_differences(const Pair& pair, double tolerance) {
  constexpr double h = 1e-3;  // five points: h^4/30 of truncation, 1e-12 of rounding
  ImuFactor::Residual r;
  ImuFactor::Jacobian J;
  pair.factor.evaluate_unwhitened(pair.xi, pair.xj, &r, &J);
  EXPECT_EQ(r, residual(pair.factor, pair.xi, pair.xj));  // the same with and without J
  for (int column = 0; column < 2 * body::kSize; ++column) {
    const bool first = column < body::kSize;
    const auto moved = [&](double step) {
      const test::BodyVector e = step * test::BodyVector::Unit(column % body::kSize);
      return first ? residual(pair.factor, test::perturbed(pair.xi, e), pair.xj)
                   : residual(pair.factor, pair.xi, test::perturbed(pair.xj, e));
    };
    const ImuFactor::Residual expected =
        (8.0 * (moved(h) - moved(-h)) - moved(2 * h) + moved(-2 * h)) / (12.0 * h);
    EXPECT_LT((J.col(column) - expected).cwiseAbs().maxCoeff(), tolerance) << "column " << column;
  }
}

TEST(ImuFactor, JacobianIsTheDerivativeOfTheResidual) {
  test::Random random(19);
  for (const double rate : kRates) {
    for (int i = 0; i < 5; ++i) {
      expect_jacobian_of_differences(random_pair(random, rate, 0.0, 0.0), 1e-10);
      expect_jacobian_of_differences(random_pair(random, rate, 1e-9, 1e-9), 1e-10);
      expect_jacobian_of_differences(random_pair(random, rate, 0.3, 0.2), 1e-10);
      // 2.5 rad: the fifth derivative of the logarithm is near 100 there
      expect_jacobian_of_differences(random_pair(random, rate, 2.5, 5.0), 1e-9);
    }
  }
}

TEST(ImuFactor, JacobianAtIdentityAndRest) {
  Pair pair;
  const ImuStep step{Time{0}, from_seconds(0.1), Vector3d::Zero(), 9.81 * Vector3d::UnitZ(), 0.0};
  pair.factor = ImuFactor(preintegrate({step}, Vector3d::Zero(), Vector3d::Zero()), 9.81);
  EXPECT_LT(residual(pair.factor, pair.xi, pair.xj).norm(), 1e-15);
  expect_jacobian_of_differences(pair, 1e-10);
}

TEST(ImuFactor, ResidualIsTheErrorOfThePrediction) {
  test::Random random(20);
  for (const double rate : kRates) {
    const Pair pair = random_pair(random, rate, 0.3, 0.2);
    const NavState predicted = predict(pair.factor.imu(), pair.xi, 9.81);
    // positions of 5 m, rounded
    EXPECT_LT(residual(pair.factor, pair.xi, predicted).norm(), 1e-13);
    const test::BodyVector expected =
        to_world(pair.xi.q_WB).transpose() * test::error_of(pair.xj, predicted);
    EXPECT_LT((residual(pair.factor, pair.xi, pair.xj) - expected).norm(), 1e-13);
  }
}

TEST(ImuFactor, WhitenedByItsCovariance) {
  test::Random random(21);
  const Pair pair = random_pair(random, 1.5, 0.01, 0.01);
  ImuFactor::Residual r;
  ImuFactor::Residual white_r;
  ImuFactor::Jacobian J;
  ImuFactor::Jacobian white_J;
  pair.factor.evaluate_unwhitened(pair.xi, pair.xj, &r, &J);
  pair.factor.evaluate(pair.xi, pair.xj, &white_r, &white_J);
  const Eigen::FullPivLU<Matrix15d> S(pair.factor.imu().covariance());
  const double cost = r.dot(S.solve(r));
  EXPECT_NEAR(white_r.squaredNorm() / cost, 1.0, 1e-12);  // solved by another decomposition
  const Eigen::Matrix<double, 30, 30> H = J.transpose() * S.solve(J);
  const Eigen::Matrix<double, 30, 30> white_H = white_J.transpose() * white_J;
  EXPECT_LT((white_H - H).cwiseAbs().maxCoeff() / H.cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::Matrix<double, 30, 1> gradient = J.transpose() * S.solve(r);
  EXPECT_LT((white_J.transpose() * white_r - gradient).norm() / gradient.norm(), 1e-12);
}

}  // namespace
}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Preintegration against strapdown integration step by step, whose noise is held against quadrature
// in strapdown_test.cpp; the factor made of it against central differences, and its statistics.
#include "rio/smoother/preintegration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "rio/smoother/imu_factor.hpp"
#include "support/constants.hpp"
#include "support/strapdown_case.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

// At rest but for rounding, as flown, and beyond any gyro's range [rad/s].
constexpr double kRates[] = {1e-9, 1.5, 30.0};

Preintegration preintegrate(const Steps& steps, const Vector3d& gyro_bias,
                            const Vector3d& accel_bias, const ImuOptions& options = {}) {
  Preintegration out;
  out.reset(gyro_bias, accel_bias);
  for (const ImuStep& step : steps) out.step(step, options);
  return out;
}

// The state after the last step, starting `from` the state at the first, with its biases.
NavState predict(const Preintegration& imu, const NavState& from) {
  const ImuIncrement d = imu.corrected(from.gyro_bias, from.accel_bias);
  const double T = to_seconds(imu.duration());
  const Matrix3d R = from.q_WB.toRotationMatrix();
  const Vector3d g(0.0, 0.0, -kGravity);
  NavState out = from;
  out.time += imu.duration();
  out.q_WB = (from.q_WB * d.delta_q).normalized();
  out.p_WB += R * d.delta_p + (from.v_WB + 0.5 * T * g) * T;
  out.v_WB += R * d.delta_v + g * T;
  return out;
}

// From the increment of body i to the navigation error in W.
Matrix15d to_world(const Quaternion& q_WB) {
  Matrix15d M = Matrix15d::Identity();
  M.block<3, 3>(body::kPosition, body::kPosition) = q_WB.toRotationMatrix();
  M.block<3, 3>(body::kVelocity, body::kVelocity) = q_WB.toRotationMatrix();
  return M;
}

TEST(Preintegration, PredictEqualsStrapdown) {
  Random random(11);
  for (const double rate : kRates) {
    for (int i = 0; i < 10; ++i) {
      NavState from = random.state();
      const Steps steps = random_steps(random, 60, rate);
      from.time = steps.front().begin;
      NavState expected = from;
      for (const ImuStep& step : steps) integrate(step, kGravity, expected);
      const NavState actual = predict(preintegrate(steps, from.gyro_bias, from.accel_bias), from);
      EXPECT_EQ(actual.time, expected.time);
      // 60 additions to some 20 m, rounded at 4e-15 each
      EXPECT_LT(error_of(expected, actual).cwiseAbs().maxCoeff(), 2e-13) << rate;
    }
  }
}

TEST(Preintegration, TransitionAndCovarianceEqualPropagation) {
  Random random(12);
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
  Random random(14);
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
  Random random(17);
  Steps steps = random_steps(random, 5, 1.5);
  steps[2].gap = 0.3;
  Preintegration imu = preintegrate(steps, Vector3d(1, 2, 3), Vector3d(4, 5, 6));
  EXPECT_EQ(imu.gyro_bias(), Vector3d(1, 2, 3));
  EXPECT_EQ(imu.accel_bias(), Vector3d(4, 5, 6));
  imu.reset(Vector3d::Zero(), Vector3d::Zero());
  EXPECT_EQ(imu.duration(), Time{0});
  EXPECT_FALSE(imu.gap());
  EXPECT_FALSE(ImuFactor(imu, kGravity).valid());  // no step, no covariance
  EXPECT_FALSE(ImuFactor().valid());
  const NavState from = random.state();
  EXPECT_LT(error_of(from, predict(imu, from)).norm(), 1e-15);
  steps[4].accel_B.z() = std::numeric_limits<double>::quiet_NaN();
  imu = preintegrate(steps, Vector3d::Zero(), Vector3d::Zero());
  EXPECT_FALSE(imu.finite());
  EXPECT_FALSE(ImuFactor(imu, kGravity).valid());
}

// Every combination of noise densities set to zero, from one sample to a second.
TEST(ImuFactor, IsRegularWithoutNoise) {
  Random random(18);
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
        EXPECT_TRUE(ImuFactor(imu, kGravity).valid());
        const Matrix15d S = imu.covariance();
        const Matrix15d I = Matrix15d::Identity();
        EXPECT_LT((whitened(S, S) - I).cwiseAbs().maxCoeff(), 1e-12) << zeros << ' ' << count;
        EXPECT_LT(solve(S, I).diagonal().maxCoeff(), 1e17);
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
Pair random_pair(Random& random, double rate, double attitude, double motion) {
  Pair out;
  out.xi = random.state();
  const Vector3d gyro_bias = out.xi.gyro_bias + random.normal_vector(0.05);
  const Vector3d accel_bias = out.xi.accel_bias + random.normal_vector(0.2);
  const Preintegration imu = preintegrate(random_steps(random, 20, rate), gyro_bias, accel_bias);
  out.factor = ImuFactor(imu, kGravity);
  BodyVector e;
  e << attitude * random.direction(), random.normal_vector(motion), random.normal_vector(motion),
      random.normal_vector(0.1 * motion), random.normal_vector(motion);
  out.xj = perturbed(predict(imu, out.xi), e);
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
      const BodyVector e = step * BodyVector::Unit(column % body::kSize);
      return first ? residual(pair.factor, perturbed(pair.xi, e), pair.xj)
                   : residual(pair.factor, pair.xi, perturbed(pair.xj, e));
    };
    const ImuFactor::Residual expected =
        (8.0 * (moved(h) - moved(-h)) - moved(2 * h) + moved(-2 * h)) / (12.0 * h);
    EXPECT_LT((J.col(column) - expected).cwiseAbs().maxCoeff(), tolerance) << "column " << column;
  }
}

TEST(ImuFactor, JacobianIsTheDerivativeOfTheResidual) {
  Random random(19);
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

TEST(ImuFactor, ResidualIsTheErrorOfThePrediction) {
  Random random(20);
  for (const double rate : kRates) {
    const Pair pair = random_pair(random, rate, 0.3, 0.2);
    const NavState predicted = predict(pair.factor.imu(), pair.xi);
    // positions of 5 m, rounded
    EXPECT_LT(residual(pair.factor, pair.xi, predicted).norm(), 1e-13);
    const BodyVector expected = to_world(pair.xi.q_WB).transpose() * error_of(pair.xj, predicted);
    EXPECT_LT((residual(pair.factor, pair.xi, pair.xj) - expected).norm(), 1e-13);
  }
}

TEST(ImuFactor, WhitenedByItsCovariance) {
  Random random(21);
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
}  // namespace rio::test

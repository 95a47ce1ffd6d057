// SPDX-License-Identifier: BSD-3-Clause
// Preintegration against strapdown integration step by step, against Monte Carlo, and the factor
// between two states against central differences.
#include "rio/smoother/preintegration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "rio/smoother/imu_factor.hpp"
#include "support/allocation_guard.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

using Steps = std::vector<ImuStep>;

// At rest but for rounding, as flown, and beyond any gyro's range [rad/s].
constexpr double kRates[] = {1e-9, 1.5, 30.0};

// Steps of 2 to 20 ms with independent readings: harder than any flight.
Steps random_steps(test::Random& random, int count, double rate) {
  Steps steps;
  Time time = from_seconds(12.5);
  for (int i = 0; i < count; ++i) {
    const Time end = time + from_seconds(random.uniform(0.002, 0.02));
    steps.push_back({time, end, random.normal_vector(rate), random.normal_vector(6.0), 0.0});
    time = end;
  }
  return steps;
}

double seconds(const ImuStep& step) {
  return to_seconds(step.end - step.begin);
}

Preintegration preintegrate(const Steps& steps, const Vector3d& gyro_bias,
                            const Vector3d& accel_bias, const ImuOptions& options = {}) {
  Preintegration out;
  out.reset(gyro_bias, accel_bias);
  for (const ImuStep& step : steps) out.step(step, options);
  return out;
}

// From the increment of body i to the navigation error in W.
Matrix15d to_world(const Quaternion& q_WB) {
  Matrix15d M = Matrix15d::Identity();
  M.block<3, 3>(body::kPosition, body::kPosition) = q_WB.toRotationMatrix();
  M.block<3, 3>(body::kVelocity, body::kVelocity) = q_WB.toRotationMatrix();
  return M;
}

// Largest entry of A - B, each relative to the sigmas of B.
double relative_difference(const Matrix15d& A, const Matrix15d& B) {
  const test::BodyVector inverse_sigma = B.diagonal().cwiseSqrt().cwiseInverse();
  return (inverse_sigma.asDiagonal() * (A - B) * inverse_sigma.asDiagonal()).cwiseAbs().maxCoeff();
}

// L^-1 C L^-T with S = L L^T.
Matrix15d whitened(const Matrix15d& C, const Matrix15d& S) {
  const Eigen::LLT<Matrix15d> llt(S);
  EXPECT_EQ(llt.info(), Eigen::Success);
  const Matrix15d inverse = llt.matrixL().solve(Matrix15d::Identity());
  return inverse * C * inverse.transpose();
}

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
    EXPECT_LT((M * imu.transition() * M.transpose() - reference.transition).cwiseAbs().maxCoeff(),
              1e-13);
    EXPECT_LT(relative_difference(M * imu.covariance() * M.transpose(), reference.noise), 1e-12);
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
    // sums of 40 terms; the error of the quadrature over 0.02 s is smaller than their rounding
    EXPECT_LT(relative_difference(b.covariance(), a.covariance()), 1e-13);
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
        const Matrix15d& S = imu.covariance();
        const Matrix15d I = Matrix15d::Identity();
        EXPECT_LT((whitened(S, S) - I).cwiseAbs().maxCoeff(), 1e-12) << zeros << ' ' << count;
        EXPECT_LT(Eigen::LLT<Matrix15d>(S).solve(I).diagonal().maxCoeff(), 1e17);
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
  out.xj = test::perturbed(imu.predict(out.xi, 9.81), e);
  return out;
}

ImuFactor::Residual residual(const ImuFactor& factor, const NavState& xi, const NavState& xj) {
  ImuFactor::Residual r;
  factor.evaluate_unwhitened(InertialState(xi), InertialState(xj), &r, nullptr);
  return r;
}

void expect_jacobian_of_differences(const Pair& pair, double tolerance) {
  constexpr double h = 1e-3;  // five points: h^4/30 of truncation, 1e-12 of rounding
  ImuFactor::Residual r;
  ImuFactor::Jacobian J;
  pair.factor.evaluate_unwhitened(InertialState(pair.xi), InertialState(pair.xj), &r, &J);
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
    const NavState predicted = pair.factor.imu().predict(pair.xi, 9.81);
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
  pair.factor.evaluate_unwhitened(InertialState(pair.xi), InertialState(pair.xj), &r, &J);
  pair.factor.evaluate(InertialState(pair.xi), InertialState(pair.xj), &white_r, &white_J);
  const Eigen::FullPivLU<Matrix15d> S(pair.factor.imu().covariance());
  const double cost = r.dot(S.solve(r));
  EXPECT_NEAR(white_r.squaredNorm() / cost, 1.0, 1e-12);  // solved by another decomposition
  const Eigen::Matrix<double, 30, 30> H = J.transpose() * S.solve(J);
  const Eigen::Matrix<double, 30, 30> white_H = white_J.transpose() * white_J;
  EXPECT_LT((white_H - H).cwiseAbs().maxCoeff() / H.cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::Matrix<double, 30, 1> gradient = J.transpose() * S.solve(r);
  EXPECT_LT((white_J.transpose() * white_r - gradient).norm() / gradient.norm(), 1e-12);
}

TEST(ImuFactor, StateConvertsAndRetractsAsTheErrorIsDefined) {
  test::Random random(22);
  for (int i = 0; i < 5; ++i) {
    const NavState x = random.state();
    test::BodyVector e;
    for (int k = 0; k < body::kSize; ++k) e[k] = random.normal(0.5);
    const InertialState actual = retract(InertialState(x), e);
    const InertialState expected(test::perturbed(x, e));
    EXPECT_LT((actual.T_WB.R - expected.T_WB.R).norm(), 1e-14);
    EXPECT_LT((actual.T_WB.p - expected.T_WB.p).norm(), 1e-14);
    EXPECT_LT((actual.v_WB - expected.v_WB).norm(), 1e-14);
    EXPECT_LT((actual.gyro_bias - expected.gyro_bias).norm(), 1e-14);
    EXPECT_LT((actual.accel_bias - expected.accel_bias).norm(), 1e-14);
  }
}

// A fixed flight measured again and again, preintegrated at biases that are wrong by what a filter
// is wrong by: the squared norm of the whitened residual at the truth has mean 15.
TEST(ImuFactor, NisAtTheTruth) {
  constexpr int kRuns = 3000;
  ImuOptions options;
  options.gyro_random_walk = 1e-3;
  options.accel_random_walk = 1e-2;
  test::Random random(23);
  const NavState start = random.state();
  const Steps flight = random_steps(random, 20, 1.5);  // without bias and noise
  test::BodyVector squares = test::BodyVector::Zero();
  for (int run = 0; run < kRuns; ++run) {
    NavState truth = start;
    Preintegration imu;
    imu.reset(truth.gyro_bias + random.normal_vector(1e-3),
              truth.accel_bias + random.normal_vector(1e-2));
    for (ImuStep step : flight) {
      const double dt = seconds(step);
      const Vector3d gyro_walk = random.normal_vector(options.gyro_random_walk * std::sqrt(dt));
      const Vector3d accel_walk = random.normal_vector(options.accel_random_walk * std::sqrt(dt));
      ImuStep measured = step;
      measured.gyro_B += truth.gyro_bias + 0.5 * gyro_walk +
                         random.normal_vector(options.gyro_noise_density / std::sqrt(dt));
      measured.accel_B += truth.accel_bias + 0.5 * accel_walk +
                          random.normal_vector(options.accel_noise_density / std::sqrt(dt));
      imu.step(measured, options);
      step.gyro_B += truth.gyro_bias;
      step.accel_B += truth.accel_bias;
      integrate(step, options.gravity, truth);
      truth.gyro_bias += gyro_walk;
      truth.accel_bias += accel_walk;
    }
    const ImuFactor factor(imu, options.gravity);
    ASSERT_TRUE(factor.valid());
    ImuFactor::Residual r;
    factor.evaluate(InertialState(start), InertialState(truth), &r, nullptr);
    squares += r.cwiseAbs2() / kRuns;
  }
  EXPECT_NEAR(squares.sum(), 15.0, 4.0 * std::sqrt(2.0 * 15.0 / kRuns));  // 4 sigma: 0.4
  for (int i = 0; i < body::kSize; ++i) {
    EXPECT_NEAR(squares[i], 1.0, 4.5 * std::sqrt(2.0 / kRuns)) << i;  // 15 figures: 4.5 sigma
  }
}

TEST(ImuFactor, DoesNotAllocate) {
  if (!test::AllocationGuard::kWorks) GTEST_SKIP() << "not counted under a sanitizer";
  test::Random random(24);
  const Steps steps = random_steps(random, 20, 1.5);
  const NavState from = random.state();
  double sum = 0.0;
  const test::AllocationGuard guard;
  Preintegration imu;
  imu.reset(from.gyro_bias, from.accel_bias);
  for (const ImuStep& step : steps) imu.step(step, ImuOptions{});
  ImuFactor factor;
  factor = ImuFactor(imu, 9.81);
  ImuFactor::Residual r;
  ImuFactor::Jacobian J;
  factor.evaluate(InertialState(from), InertialState(imu.predict(from, 9.81)), &r, &J);
  sum += r.norm() + J.norm();
  EXPECT_EQ(guard.count(), 0);
  EXPECT_GT(sum, 0.0);
}

}  // namespace
}  // namespace rio

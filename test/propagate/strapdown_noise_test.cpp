// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>
#include <vector>

#include "rio/propagate/strapdown.hpp"
#include "support/constants.hpp"
#include "support/random_state.hpp"
#include "support/strapdown_case.hpp"
#include "support/symmetric.hpp"

namespace rio {
namespace {

using test::kGravity;

using Case = test::StrapdownCase;

// Largest entry of A - B, each relative to the sigmas of B.
double relative_difference(const Matrix15d& A, const Matrix15d& B) {
  const test::BodyVector sigma = B.diagonal().cwiseSqrt();
  double worst = 0.0;
  for (int i = 0; i < body::kSize; ++i) {
    for (int j = 0; j < body::kSize; ++j) {
      const double scale = sigma[i] * sigma[j];
      const double difference = std::abs(A(i, j) - B(i, j));
      worst = std::max(worst, scale > 0.0 ? difference / scale : difference);
    }
  }
  return worst;
}

double asymmetry(const Matrix15d& Q) {
  const Matrix15d transposed = Q.transpose();
  return relative_difference(transposed, Q);
}

// dQ/dt = F Q + Q F^T + G Qc G^T with F, G of the linear error equations, by Runge-Kutta.
Matrix15d noise_reference(const Case& c, double dt, const ProcessNoise& n) {
  using namespace body;
  const auto derivative = [&](const Matrix15d& Q, double t) -> Matrix15d {
    const Matrix3d R = c.rotation() * test::rotation_of(c.w() * t).toRotationMatrix();
    Matrix15d F = Matrix15d::Zero();
    F.block<3, 3>(kAttitude, kAttitude) = -skew(c.w());
    F.block<3, 3>(kAttitude, kGyroBias) = -Matrix3d::Identity();
    F.block<3, 3>(kVelocity, kAttitude) = -R * skew(c.a());
    F.block<3, 3>(kVelocity, kAccelBias) = -R;
    F.block<3, 3>(kPosition, kVelocity) = Matrix3d::Identity();
    Matrix15d out = F * Q + Q * F.transpose();
    out.diagonal().segment<3>(kAttitude).array() += n.gyro;
    out.diagonal().segment<3>(kVelocity).array() += n.accel;
    out.diagonal().segment<3>(kGyroBias).array() += n.gyro_walk;
    out.diagonal().segment<3>(kAccelBias).array() += n.accel_walk;
    return out;
  };
  constexpr int kSubsteps = 400;
  const double h = dt / kSubsteps;
  Matrix15d Q = Matrix15d::Zero();
  for (int i = 0; i < kSubsteps; ++i) {
    const double t = i * h;
    const Matrix15d k1 = derivative(Q, t);
    const Matrix15d k2 = derivative(Q + 0.5 * h * k1, t + 0.5 * h);
    const Matrix15d k3 = derivative(Q + 0.5 * h * k2, t + 0.5 * h);
    const Matrix15d k4 = derivative(Q + h * k3, t + h);
    Q += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return Q;
}

std::vector<std::pair<Case, double>> cases_and_steps() {
  std::vector<std::pair<Case, double>> out;
  for (const Case& c : test::strapdown_cases(3, 1.2)) {
    for (const double dt : test::kStrapdownSteps) out.emplace_back(c, dt);
  }
  return out;
}

TEST(ProcessNoise, SolvesTheLyapunovEquation) {
  const ProcessNoise usual{1.6e-7, 1.6e-5, 4e-10, 4e-8};
  const ProcessNoise gyro{1e-4, 1e-12, 1e-14, 1e-14};
  const ProcessNoise gyro_walk{1e-14, 1e-14, 1e-4, 1e-14};
  const ProcessNoise accel_walk{1e-14, 1e-14, 1e-14, 1e-4};
  for (const ProcessNoise& n : {usual, gyro, gyro_walk, accel_walk}) {
    const bool walks = n.gyro < 1e-10;
    for (const auto& [c, dt] : cases_and_steps()) {
      const Matrix15d Q = process_noise_covariance(c.rotation(), c.w(), c.a(), dt, n).matrix();
      EXPECT_LT(asymmetry(Q), 1e-15);
      // exact without rotation; steps are cut at 0.05 rad
      const double phi = std::min(0.05, c.w().norm() * dt);
      const double error = walks ? phi / 3.0 : phi * phi / 12.0;
      EXPECT_LT(relative_difference(Q, noise_reference(c, dt, n)), 3e-9 + error) << dt;
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

// Sample covariance of the error of a strapdown fed with noise, whitened by Q: the identity.
TEST(ProcessNoise, EqualsMonteCarlo) {
  constexpr int kRuns = 10000;
  constexpr int kSubsteps = 20;
  constexpr double dt = 0.4;
  constexpr double h = dt / kSubsteps;
  const ProcessNoise n{1e-6, 1e-4, 1e-6, 1e-4};
  const Case c = test::strapdown_cases(3, 1.2).back();
  test::Random random(2);
  NavState nominal = c.state;
  integrate(c.gyro, c.accel, dt, kGravity, nominal);
  Matrix15d sum = Matrix15d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    NavState x = c.state;
    for (int i = 0; i < kSubsteps; ++i) {
      x.gyro_bias += random.normal_vector(std::sqrt(0.5 * n.gyro_walk * h));
      x.accel_bias += random.normal_vector(std::sqrt(0.5 * n.accel_walk * h));
      integrate(c.gyro + random.normal_vector(std::sqrt(n.gyro / h)),
                c.accel + random.normal_vector(std::sqrt(n.accel / h)), h, kGravity, x);
      x.gyro_bias += random.normal_vector(std::sqrt(0.5 * n.gyro_walk * h));
      x.accel_bias += random.normal_vector(std::sqrt(0.5 * n.accel_walk * h));
    }
    const test::BodyVector e = test::error_of(x, nominal);
    sum += e * e.transpose();
  }
  const Matrix15d Q = process_noise_covariance(c.rotation(), c.w(), c.a(), dt, n).matrix();
  const Matrix15d whitened = test::whitened(sum / kRuns, Q);
  // sqrt(2/10000) = 0.014 on the diagonal, 0.01 off it: 5 sigma for 120 entries
  EXPECT_LT((whitened - Matrix15d::Identity()).cwiseAbs().maxCoeff(), 0.07);
}

TEST(ProcessNoise, InAGapEqualsMonteCarlo) {
  using namespace body;
  ImuOptions o;
  o.gyro_noise_density = o.gyro_random_walk = o.accel_noise_density = o.accel_random_walk = 0.0;
  o.gap_rate_sigma = 0.05;
  o.gap_accel_sigma = 2.0;
  constexpr double dt = 0.3;
  Case c;
  c.accel = kGravity * Vector3d::UnitZ();
  ImuBuffer imu(TimingOptions{}, o);
  imu.push_back({Time{0}, c.gyro, c.accel});
  imu.push_back({from_seconds(dt), c.gyro, c.accel});
  ImuStep step;
  imu.for_each_step(Time{0}, from_seconds(dt), [&step](const ImuStep& only) { step = only; });
  ASSERT_GT(step.gap, 0.0);
  ImuStep quiet = step;
  quiet.gap = 0.0;
  EXPECT_EQ(process_noise(o, quiet).gyro, 0.0);
  EXPECT_EQ(process_noise(o, quiet).accel, 0.0);
  const Matrix15d Q =
      process_noise_covariance(c.rotation(), c.w(), c.a(), dt, process_noise(o, step)).matrix();

  constexpr int kRuns = 10000;
  test::Random random(3);
  NavState nominal = c.state;
  integrate(c.gyro, c.accel, dt, kGravity, nominal);
  Matrix15d sum = Matrix15d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    NavState x = c.state;
    integrate(c.gyro + random.normal_vector(o.gap_rate_sigma),
              c.accel + random.normal_vector(o.gap_accel_sigma), dt, kGravity, x);
    const test::BodyVector e = test::error_of(x, nominal);
    sum += e * e.transpose() / kRuns;
  }
  for (int i = 0; i < 3; ++i) {
    // sqrt(2/10000) = 0.014; white noise of the same density moves the position by 4/3 as much
    EXPECT_NEAR(Q(kAttitude + i, kAttitude + i) / sum(kAttitude + i, kAttitude + i), 1.0, 0.06);
    EXPECT_NEAR(Q(kVelocity + i, kVelocity + i) / sum(kVelocity + i, kVelocity + i), 1.0, 0.06);
    EXPECT_NEAR(Q(kPosition + i, kPosition + i) / sum(kPosition + i, kPosition + i), 4.0 / 3.0,
                0.08);
  }
}

std::vector<ImuStep> random_steps(test::Random& random, int count) {
  std::vector<ImuStep> steps;
  Time time{0};
  for (int i = 0; i < count; ++i) {
    const Time end = time + from_seconds(random.uniform(0.002, 0.02));
    steps.push_back({time, end, random.normal_vector(1.0), random.normal_vector(6.0), false});
    time = end;
  }
  return steps;
}

TEST(Propagation, AccumulatesTheProductChain) {
  test::Random random(4);
  const ImuOptions o;
  Propagation p;
  p.state = random.state();
  NavState x = p.state;
  const BodyCovariance P0 = 1e-4 * BodyCovariance::Identity();
  Matrix15d P = P0;
  for (const ImuStep& step : random_steps(random, 30)) {
    const double dt = to_seconds(step.end - step.begin);
    const Matrix3d R = x.q_WB.toRotationMatrix();
    const Vector3d w = step.gyro_B - x.gyro_bias;
    const Vector3d a = step.accel_B - x.accel_bias;
    const Matrix15d phi = transition(R, w, a, dt);
    P = (phi * P * phi.transpose() +
         process_noise_covariance(R, w, a, dt, process_noise(o, step)).matrix())
            .eval();
    integrate(step, o.gravity, x);
    p.step(step, o);
  }
  EXPECT_EQ(p.state.time, x.time);
  EXPECT_LT(test::error_of(x, p.state).norm(), 1e-15);
  const Matrix15d once = p.transition() * P0 * p.transition().transpose() + p.noise();
  EXPECT_LT(relative_difference(once, P), 1e-12);  // 30 products
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
  std::vector<ImuStep> steps = random_steps(random, 3);
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

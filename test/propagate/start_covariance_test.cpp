// SPDX-License-Identifier: BSD-3-Clause
// Monte Carlo of the alignment at rest: errors are as large as its covariance says.
#include <gtest/gtest.h>

#include <initializer_list>

#include "propagate/standing_imu.hpp"
#include "rio/core/so3.hpp"
#include "support/measured.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

/// Squared errors over their variances and over their number: of tilt, accelerometer bias and gyro
/// bias (8), of the tilt (2) and of the gyro bias alone (3), of the specific force predicted across
/// gravity (2), the same without the covariance of tilt and accelerometer bias.
enum Error : int { kJoint, kTilt, kGyroBias, kForce, kForceUncorrelated, kErrors };
using Nees = Eigen::Matrix<double, kErrors, 1>;

Nees nees(const StandingImu& imu, const Alignment& alignment) {
  using namespace body;
  const NavState& x = alignment.state;
  const Vector3d y = x.q_WB.conjugate() * Vector3d::UnitZ();
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = y.unitOrthogonal();
  across.col(1) = y.cross(Vector3d(across.col(0)));
  // up_B = Exp(-theta) y, theta across y
  const Vector3d turn = imu.up_B.cross(y);
  BodyVector e = BodyVector::Zero();
  e.segment<3>(kAttitude) = turn.normalized() * std::asin(turn.norm());
  e.segment<3>(body::kGyroBias) = imu.gyro_bias - x.gyro_bias;
  e.segment<3>(kAccelBias) = imu.accel_bias - x.accel_bias;

  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(8, kSize);
  joint.block<2, 3>(0, kAttitude) = across.transpose();
  joint.block<3, 3>(2, kAccelBias).setIdentity();
  joint.block<3, 3>(5, body::kGyroBias).setIdentity();
  // f_B = Exp(-theta) g y + b_a: its error is g y x theta + db_a
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(2, kSize);
  force.middleCols<3>(kAttitude) = across.transpose() * kGravity * skew(y);
  force.middleCols<3>(kAccelBias) = across.transpose();

  const auto of = [&e](const Eigen::MatrixXd& H, const BodyCovariance& P) {
    const Eigen::VectorXd error = H * e;
    return error.dot(solve(H * P * H.transpose(), error).col(0)) / static_cast<double>(H.rows());
  };
  const BodyCovariance& P = alignment.covariance;
  BodyCovariance uncorrelated = P;
  uncorrelated.block<3, 3>(kAttitude, kAccelBias).setZero();
  uncorrelated.block<3, 3>(kAccelBias, kAttitude).setZero();
  return {of(joint, P), of(joint.topRows(2), P), of(joint.bottomRows(3), P), of(force, P),
          of(force, uncorrelated)};
}

/// A vehicle that stands for a while, its samples with this noise.
struct Standing {
  const char* name;
  double gyro_density = 4e-4;     ///< as declared [rad/s/sqrt(Hz)]
  double gyro_sigma = 5.7e-3;     ///< of a sample, here from the default density [rad/s]
  double accel_sigma = 5.7e-2;    ///< same [m/s^2]
  double gyro_bias_sigma = 3e-3;  ///< [rad/s]
  double moved_after = 10.0;      ///< [s]
};
struct Bounds {
  Error error;
  double low, high;
};

/// The means over 400 starts of random biases and mountings are within the bounds.
void expect_nees(const Standing& standing, std::initializer_list<Bounds> bounds) {
  constexpr int kRuns = 400;
  ImuOptions options;
  options.gyro_noise_density = standing.gyro_density;
  Random random(3);
  Nees sum = Nees::Zero();
  int aligned = 0;
  for (int run = 0; run < kRuns; ++run) {
    StandingImu imu;
    imu.up_B = random.direction();
    imu.gyro_sigma = standing.gyro_sigma;
    imu.accel_sigma = standing.accel_sigma;
    imu.gravity = kGravity + random.normal(0.02);  // spread over the Earth
    imu.gyro_bias = random.normal_vector(standing.gyro_bias_sigma);
    imu.accel_bias = random.normal_vector(StartOptions{}.sigma_accel_bias);
    const Vector3d aside = imu.up_B.unitOrthogonal();
    imu.motion = [&](double t, ImuSample& s) {
      if (t > standing.moved_after) s.accel_B += 4.0 * std::sin(40.0 * t) * aside;
    };
    const Outcome out = align(imu, random, StartOptions{}, options);
    if (!out.alignment) continue;
    EXPECT_LT(out.alignment->state.time, imu.start() + from_seconds(standing.moved_after));
    sum += nees(imu, *out.alignment);
    ++aligned;
  }
  // in half a second three sigmas of noise look like motion
  EXPECT_GE(aligned, standing.moved_after < 1.0 ? 0.95 * kRuns : kRuns);
  for (const Bounds& b : bounds) {
    SCOPED_TRACE(b.error);
    expect_between(standing.name, sum[b.error] / aligned, b.low, b.high);
  }
}

TEST(StartCovariance, IsConsistentAndItsCorrelationMatters) {
  // far above the floor of 1e-4 rad/s given to the gyro bias
  expect_nees({.name = "NEES of a start: all, force, force as if uncorrelated",
               .gyro_density = 4e-3,
               .gyro_sigma = 5.7e-2,
               .gyro_bias_sigma = 0.01},
              // 3.5 sigma of a mean over 400: sqrt(2 / 8 / 400) = 0.025, sqrt(2 / 2 / 400) = 0.05
              {{kJoint, 0.9125, 1.0875}, {kForce, 0.825, 1.175}, {kForceUncorrelated, 0.0, 0.025}});
}

// White vibration far above the declared noise, as of an engine: what it does to the means is in
// the covariance, though the declared densities do not know of it.
TEST(StartCovariance, KnowsTheNoiseOfAHummingVehicle) {
  // the scatter of six means is a variance from 15 degrees of freedom: E[1 / x] is 15 / 13
  expect_nees(
      {.name = "NEES of a humming start: gyro bias, force", .gyro_sigma = 0.03, .accel_sigma = 0.5},
      {{kGyroBias, 0.7, 1.3}, {kForce, 0.7, 1.4}});
}

// Its larger sigmas are those of its errors; (E4) takes the larger of two noises.
TEST(StartCovariance, OfHalfASecondOfRestIsHonest) {
  expect_nees({.name = "NEES of half a second of rest: gyro bias, tilt", .moved_after = 0.52},
              {{kGyroBias, 0.5, 1.1}, {kTilt, 0.7, 1.3}});
}

}  // namespace
}  // namespace rio::test

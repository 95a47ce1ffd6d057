// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/static_alignment.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "support/constants.hpp"
#include "support/measured.hpp"
#include "support/random_state.hpp"
#include "support/symmetric.hpp"

namespace rio {
namespace {

constexpr double kRate = 200.0;  // [Hz]
using test::kGravity;

// A resting IMU; `motion` may add to a sample what moves it, t seconds after the start.
struct Imu {
  Vector3d up_B = Vector3d::UnitZ();
  double gravity = kGravity;
  Vector3d gyro_bias = Vector3d::Zero();
  Vector3d accel_bias = Vector3d::Zero();
  double gyro_sigma = 0.0;
  double accel_sigma = 0.0;
  std::function<void(double t, ImuSample& sample)> motion;

  ImuSample sample(int i, test::Random& random) const {
    ImuSample s;
    s.time = Time(100'000'000'000) + Time(5'000'000) * i;
    s.gyro_B = gyro_bias + random.normal_vector(gyro_sigma);
    s.accel_B = gravity * up_B + accel_bias + random.normal_vector(accel_sigma);
    if (motion) motion(i / kRate, s);
    return s;
  }
};

struct Outcome {
  std::optional<Alignment> alignment;
  int samples = 0;
  int refusals = 0;
};

// Feeds samples from `first` on until aligned, `count` at most.
Outcome align(StaticAligner& aligner, const Imu& imu, test::Random& random, int first, int count) {
  Outcome out;
  for (; out.samples < count && !out.alignment; ++out.samples) {
    const Status status = aligner.add(imu.sample(first + out.samples, random), &out.alignment);
    EXPECT_TRUE(status == Status::kOk || status == Status::kMoving);
    EXPECT_FALSE(status == Status::kMoving && out.alignment);
    out.refusals += status == Status::kMoving ? 1 : 0;
  }
  return out;
}

// MEMS noise of one sample at the default densities.
Imu noisy(const Vector3d& up_B) {
  Imu imu;
  imu.up_B = up_B;
  imu.gyro_sigma = 4e-4 * std::sqrt(kRate);
  imu.accel_sigma = 4e-3 * std::sqrt(kRate);
  return imu;
}

TEST(StaticAlignment, RecoversTiltAndGyroBiasInAnyMounting) {
  test::Random random(1);
  for (int run = 0; run < 60; ++run) {
    Imu imu;
    const Vector3d special[] = {Vector3d::UnitZ(),  -Vector3d::UnitZ(), Vector3d::UnitX(),
                                -Vector3d::UnitX(), Vector3d::UnitY(),  -Vector3d::UnitY()};
    imu.up_B = run < 6 ? special[run] : random.direction();
    // across the vertical any bias is one; a rate about it might be a turn
    const Vector3d bias = random.uniform(0.0, 0.09) * random.direction();
    imu.gyro_bias = bias - 0.9 * bias.dot(imu.up_B) * imu.up_B;
    StaticAligner aligner(StartOptions{}, ImuOptions{});
    const Outcome out = align(aligner, imu, random, 0, 400);
    ASSERT_TRUE(out.alignment) << imu.up_B.transpose();
    EXPECT_EQ(out.samples, 301);  // 1.5 s at 200 Hz, both ends included
    const NavState& x = out.alignment->state;
    EXPECT_EQ(x.time, imu.sample(300, random).time);
    EXPECT_LT((x.q_WB * imu.up_B - Vector3d::UnitZ()).norm(), 1e-12) << imu.up_B.transpose();
    EXPECT_NEAR(x.q_WB.norm(), 1.0, 1e-14);
    // 0.009 rad/s about the vertical are a turn once in 1000 starts
    const Vector3d error = x.gyro_bias - imu.gyro_bias;
    EXPECT_LT(error.norm(), 1e-3 * std::abs(imu.gyro_bias.dot(imu.up_B)) + 1e-14);
    EXPECT_LT(error.cross(imu.up_B).norm(), 1e-14);
    EXPECT_LT(x.accel_bias.norm(), 1e-12);
    EXPECT_EQ(x.p_WB, Vector3d::Zero());
    EXPECT_EQ(x.v_WB, Vector3d::Zero());
    if (std::abs(imu.up_B.x()) > 0.99) continue;
    // no heading: x of the body lies above x of the world
    const Vector3d forward = x.q_WB * Vector3d::UnitX();
    EXPECT_NEAR(forward.y(), 0.0, 1e-12);
    EXPECT_GT(forward.x(), 0.0);
  }
}

TEST(StaticAlignment, AccelerometerBiasAlongGravityIsMeasured) {
  test::Random random(2);
  Imu imu = noisy(random.direction());
  imu.accel_bias = 0.2 * imu.up_B;
  StaticAligner aligner(StartOptions{}, ImuOptions{});
  const Outcome out = align(aligner, imu, random, 0, 400);
  ASSERT_TRUE(out.alignment);
  // scalar update with the prior 0.05, the noise 0.0033 and 0.02 of local gravity
  const double gain = 0.05 * 0.05 / (0.05 * 0.05 + 0.0033 * 0.0033 + 0.02 * 0.02);
  EXPECT_NEAR(out.alignment->state.accel_bias.dot(imu.up_B), gain * 0.2, 5.0 * 0.0033);
}

// Errors of tilt (2), accelerometer bias (3) and gyro bias (3), against their joint covariance; and
// of the specific force predicted across gravity (2), with and without the covariance of tilt and
// bias.
struct Nees {
  double joint = 0.0;
  double force = 0.0;
  double force_uncorrelated = 0.0;
};

double squared_norm(const Eigen::VectorXd& e, const Eigen::MatrixXd& P) {
  return e.dot(test::solve(P, e).col(0));
}

Nees nees(const Imu& imu, const Alignment& alignment) {
  using namespace body;
  const NavState& x = alignment.state;
  const Vector3d y = x.q_WB.conjugate() * Vector3d::UnitZ();
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = y.unitOrthogonal();
  across.col(1) = y.cross(Vector3d(across.col(0)));
  // up_B = Exp(-theta) y, theta across y
  const Vector3d turn = imu.up_B.cross(y);
  const Vector3d theta = turn.normalized() * std::asin(turn.norm());

  test::BodyVector e = test::BodyVector::Zero();
  e.segment<3>(kAttitude) = theta;
  e.segment<3>(kGyroBias) = imu.gyro_bias - x.gyro_bias;
  e.segment<3>(kAccelBias) = imu.accel_bias - x.accel_bias;

  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(8, kSize);
  joint.block<2, 3>(0, kAttitude) = across.transpose();
  joint.block<3, 3>(2, kAccelBias).setIdentity();
  joint.block<3, 3>(5, kGyroBias).setIdentity();
  // f_B = Exp(-theta) g y + b_a: its error is g y x theta + db_a
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(2, kSize);
  Matrix3d y_cross;
  y_cross << 0.0, -y.z(), y.y(), y.z(), 0.0, -y.x(), -y.y(), y.x(), 0.0;
  force.middleCols<3>(kAttitude) = across.transpose() * kGravity * y_cross;
  force.middleCols<3>(kAccelBias) = across.transpose();

  const BodyCovariance& P = alignment.covariance;
  BodyCovariance uncorrelated = P;
  uncorrelated.block<3, 3>(kAttitude, kAccelBias).setZero();
  uncorrelated.block<3, 3>(kAccelBias, kAttitude).setZero();
  return {squared_norm(joint * e, joint * P * joint.transpose()),
          squared_norm(force * e, force * P * force.transpose()),
          squared_norm(force * e, force * uncorrelated * force.transpose())};
}

TEST(StaticAlignment, CovarianceIsConsistentAndItsCorrelationMatters) {
  ImuOptions options;
  options.gyro_noise_density = 4e-3;  // far above the floor of 1e-4 rad/s given to the gyro bias
  const StartOptions start;
  test::Random random(3);
  constexpr int kRuns = 400;
  Nees mean;
  for (int run = 0; run < kRuns; ++run) {
    Imu imu = noisy(random.direction());
    imu.gyro_sigma = options.gyro_noise_density * std::sqrt(kRate);
    imu.gravity = kGravity + random.normal(0.02);  // spread over the Earth
    imu.gyro_bias = random.normal_vector(0.01);
    imu.accel_bias = random.normal_vector(start.sigma_accel_bias);
    StaticAligner aligner(start, options);
    const Outcome out = align(aligner, imu, random, 0, 400);
    ASSERT_TRUE(out.alignment) << run;
    const Nees one = nees(imu, *out.alignment);
    mean.joint += one.joint / kRuns;
    mean.force += one.force / kRuns;
    mean.force_uncorrelated += one.force_uncorrelated / kRuns;
  }
  // 3.5 sigma of a mean over 400: sqrt(2 * 8 / 400) = 0.2 and sqrt(2 * 2 / 400) = 0.1
  EXPECT_NEAR(mean.joint, 8.0, 0.7);
  EXPECT_NEAR(mean.force, 2.0, 0.35);
  EXPECT_LT(mean.force_uncorrelated, 0.05);  // would be taken 15 times as uncertain as it is
}

TEST(StaticAlignment, CovarianceIsSymmetricPositiveDefiniteAndHasTheGivenSigmas) {
  using namespace body;
  StartOptions start;
  start.sigma_yaw = 0.3;
  start.sigma_position = 0.2;
  test::Random random(4);
  for (int run = 0; run < 20; ++run) {
    const Imu imu = noisy(random.direction());
    StaticAligner aligner(start, ImuOptions{});
    const Outcome out = align(aligner, imu, random, 0, 400);
    ASSERT_TRUE(out.alignment);
    const BodyCovariance& P = out.alignment->covariance;
    EXPECT_LT((P - P.transpose()).cwiseAbs().maxCoeff(), 1e-17);
    EXPECT_TRUE(test::is_positive_definite(P));
    const Vector3d y = out.alignment->state.q_WB.conjugate() * Vector3d::UnitZ();
    EXPECT_NEAR(y.dot(P.block<3, 3>(kAttitude, kAttitude) * y), 0.3 * 0.3, 1e-12);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(P(kPosition + i, kPosition + i), 0.04, 1e-15);
  }
}

// Refused while it moves, with each part of a window from the end of the first one on; aligned in
// the first window at rest, which begins with the first part at rest.
void expect_refused_then_aligned(Imu imu, const char* what) {
  test::Random random(5);
  StaticAligner aligner(StartOptions{}, ImuOptions{});
  const Outcome moving = align(aligner, imu, random, 0, 3 * 301);
  EXPECT_FALSE(moving.alignment) << what;
  EXPECT_EQ(moving.refusals, 13) << what;  // 1.5 s, 1.75 s .. 4.5 s
  imu.motion = nullptr;
  const Outcome still = align(aligner, imu, random, moving.samples, 351);
  EXPECT_TRUE(still.alignment) << what;
  EXPECT_LE(still.refusals, 6) << what;
  EXPECT_GT(still.samples, 280) << what;  // hardly any motion in it
}

TEST(StaticAlignment, RefusesMotionAndRecovers) {
  test::Random random(6);
  Imu imu = noisy(random.direction());
  const Vector3d up = imu.up_B;
  const Vector3d level = up.unitOrthogonal();
  imu.motion = [&](double t, ImuSample& s) {
    s.accel_B += 2.0 * std::sin(2.0 * M_PI * 7.0 * t) * level;
  };
  expect_refused_then_aligned(imu, "shaking");
  imu.motion = [&](double t, ImuSample& s) {
    s.gyro_B += 0.2 * std::sin(2.0 * M_PI * 7.0 * t) * level;
  };
  expect_refused_then_aligned(imu, "rocking");
  imu.motion = [&](double, ImuSample& s) { s.gyro_B += 0.3 * up; };
  expect_refused_then_aligned(imu, "turning about the vertical at 0.3 rad/s");
  imu.motion = [&](double t, ImuSample& s) {
    const double rate = 3.0 * M_PI / 180.0;
    s.gyro_B += rate * level;
    s.accel_B += kGravity * (test::rotation_of(-rate * t * level) * up - up);
  };
  expect_refused_then_aligned(imu, "tilting at 3 deg/s");
  imu.motion = [&](double, ImuSample& s) { s.accel_B += 1.0 * up; };
  expect_refused_then_aligned(imu, "accelerating upwards at 1 m/s^2");
  // forwards: from rest and back within each window; a constant one would be a tilt to any IMU
  imu.motion = [&](double t, ImuSample& s) {
    if (std::fmod(t, 301.0 / kRate) > 0.3) s.accel_B += 1.0 * level;
  };
  expect_refused_then_aligned(imu, "starting forwards at 1 m/s^2");
}

// White vibration far above the declared noise, as of an engine: what it does to the means is in
// the covariance, though the declared densities do not know of it.
TEST(StaticAlignment, AlignsOnAHummingVehicleAndKnowsTheNoise) {
  using namespace body;
  test::Random random(9);
  constexpr int kRuns = 300;
  double nees_bias = 0.0;
  double nees_force = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    Imu imu = noisy(random.direction());
    imu.gyro_sigma = 0.03;
    imu.accel_sigma = 0.5;
    imu.gyro_bias = random.normal_vector(0.003);
    imu.accel_bias = random.normal_vector(StartOptions{}.sigma_accel_bias);
    imu.gravity = kGravity + random.normal(0.02);
    StaticAligner aligner(StartOptions{}, ImuOptions{});
    const Outcome out = align(aligner, imu, random, 0, 301);
    ASSERT_TRUE(out.alignment) << run;
    const Vector3d e = imu.gyro_bias - out.alignment->state.gyro_bias;
    nees_bias += squared_norm(e, out.alignment->covariance.block<3, 3>(kGyroBias, kGyroBias));
    nees_force += nees(imu, *out.alignment).force;
  }
  test::measured("humming start: NEES of the gyro bias / 3", nees_bias / kRuns / 3.0, "0.7 to 1.3");
  test::measured("humming start: NEES of the force / 2", nees_force / kRuns / 2.0, "0.7 to 1.4");
  // the scatter of six means is a variance from 15 degrees of freedom: E[1 / x] is 15 / 13
  EXPECT_NEAR(nees_bias / kRuns / 3.0, 1.0, 0.3);
  EXPECT_GT(nees_force / kRuns / 2.0, 0.7);
  EXPECT_LT(nees_force / kRuns / 2.0, 1.4);
}

// A platform that turns by itself: either hypothesis must stay within three sigmas, and the sigma
// of rates that biases have stays small.
TEST(StaticAlignment, SlowTurnIsNoSureBias) {
  using namespace body;
  for (const double rate : {0.002, 0.01, 0.02, 0.03, 0.04, 0.05, 0.09}) {
    test::Random random(10);
    Imu imu = noisy(random.direction());
    imu.gyro_bias = rate * imu.up_B;
    StaticAligner aligner(StartOptions{}, ImuOptions{});
    const Outcome out = align(aligner, imu, random, 0, 301);
    ASSERT_TRUE(out.alignment) << rate;
    const Vector3d y = out.alignment->state.q_WB.conjugate() * Vector3d::UnitZ();
    const double sigma =
        std::sqrt(y.dot(out.alignment->covariance.block<3, 3>(kGyroBias, kGyroBias) * y));
    const double bias = y.dot(out.alignment->state.gyro_bias);
    if (rate <= 0.01) {
      EXPECT_LT(sigma, 1.5e-3) << rate;
    }
    if (rate <= 0.04) {
      EXPECT_LT(rate - bias, 3.0 * sigma) << rate << " it stood, it is a bias";
    }
    if (rate >= 0.05) {
      EXPECT_LT(bias, 3.0 * sigma) << rate << " it turned, the bias is zero";
    }
    if (rate == 0.05) {
      test::measured("alignment at 0.05 rad/s of yaw: bias [rad/s]", bias, "below 3 sigma");
      test::measured("alignment at 0.05 rad/s of yaw: sigma [rad/s]", sigma, "");
    }
    // nothing is lost across the vertical
    const Vector3d level = y.unitOrthogonal();
    EXPECT_LT(
        std::sqrt(level.dot(out.alignment->covariance.block<3, 3>(kGyroBias, kGyroBias) * level)),
        1e-3);
  }
}

// Switched on at rest and soon moved: the rest of the first window is used, with a larger sigma.
TEST(StaticAlignment, ShortRestIsEnoughInTheFirstWindowOnly) {
  const auto bias_variance = [](const Outcome& out) {
    return out.alignment->covariance(body::kGyroBias, body::kGyroBias);
  };
  const auto still_for = [](double rest, double shaken_before) {
    Imu imu = noisy(Vector3d::UnitZ());
    imu.motion = [=](double t, ImuSample& s) {
      const bool shakes = t < shaken_before || t >= shaken_before + rest;
      if (shakes) s.accel_B.x() += 4.0 * std::sin(40.0 * t);
    };
    return imu;
  };
  const auto begin = [](const Imu& imu, int count) {
    test::Random random(8);
    StaticAligner aligner(StartOptions{}, ImuOptions{});
    return align(aligner, imu, random, 0, count);
  };
  const Outcome whole = begin(still_for(2.0, 0.0), 400);
  const Outcome part = begin(still_for(1.2, 0.0), 400);
  ASSERT_TRUE(whole.alignment && part.alignment);
  EXPECT_EQ(part.alignment->state.time, Time(101'000'000'000));  // two thirds of 1.5 s
  EXPECT_LT(part.alignment->state.gyro_bias.norm(), 5.0 * 4e-4);
  EXPECT_GT(bias_variance(part), bias_variance(whole));
  const Outcome third = begin(still_for(0.7, 0.0), 400);
  ASSERT_TRUE(third.alignment);
  EXPECT_EQ(third.alignment->state.time, Time(100'500'000'000));
  EXPECT_GT(bias_variance(third), bias_variance(part));
  EXPECT_FALSE(begin(still_for(0.4, 0.0), 400).alignment);
  Imu humming = still_for(0.8, 0.0);  // an engine hides slow motion
  humming.gyro_sigma = 0.02;
  EXPECT_FALSE(begin(humming, 400).alignment);
  EXPECT_FALSE(begin(still_for(1.2, 2.0), 1000).alignment);  // no first window
}

// Half a second of rest: its larger sigmas are those of its errors.
TEST(StaticAlignment, SigmasOfAShortRestAreHonest) {
  test::Random random(12);
  constexpr int kRuns = 300;
  double gyro = 0.0, tilt = 0.0;
  int aligned = 0;
  for (int run = 0; run < kRuns; ++run) {
    Imu imu = noisy(random.direction());
    imu.gyro_bias = random.normal_vector(0.003);
    imu.accel_bias = random.normal_vector(StartOptions{}.sigma_accel_bias);
    const Vector3d aside = imu.up_B.unitOrthogonal();
    imu.motion = [&](double t, ImuSample& s) {
      if (t > 0.52) s.accel_B += 4.0 * std::sin(40.0 * t) * aside;
    };
    StaticAligner aligner(StartOptions{}, ImuOptions{});
    const Outcome out = align(aligner, imu, random, 0, 400);
    if (!out.alignment) continue;  // three sigmas of noise look like motion
    ++aligned;
    ASSERT_LT(out.alignment->state.time, Time(100'600'000'000));
    const BodyCovariance& P = out.alignment->covariance;
    const Vector3d e = out.alignment->state.gyro_bias - imu.gyro_bias;
    const Matrix3d P_gyro = P.block<3, 3>(body::kGyroBias, body::kGyroBias);
    gyro += e.dot(P_gyro.ldlt().solve(e)) / 3.0;
    const Vector3d up = out.alignment->state.q_WB.conjugate() * Vector3d::UnitZ();
    const Vector3d across = up.cross(imu.up_B);  // without the rotation about the vertical
    const Matrix3d level = Matrix3d::Identity() - up * up.transpose();
    const Matrix3d P_phi = P.block<3, 3>(body::kAttitude, body::kAttitude);
    tilt += across.squaredNorm() / (level * P_phi * level).trace();
  }
  EXPECT_GT(aligned, 0.95 * kRuns);
  EXPECT_LT(gyro / aligned, 1.1);  // (E4) takes the larger of two noises
  EXPECT_GT(gyro / aligned, 0.5);
  EXPECT_NEAR(tilt / aligned, 1.0, 0.3);
  test::measured("NEES of the gyro bias after half a second of rest", gyro / aligned, "0.5 to 1.1");
}

TEST(StaticAlignment, ResetForgetsTheWindow) {
  test::Random random(7);
  Imu moving = noisy(Vector3d::UnitZ());
  moving.gyro_bias = Vector3d(0.5, 0.0, 0.0);
  StaticAligner aligner(StartOptions{}, ImuOptions{});
  EXPECT_FALSE(align(aligner, moving, random, 0, 200).alignment);
  aligner.reset();
  const Outcome out = align(aligner, noisy(Vector3d::UnitZ()), random, 200, 301);
  EXPECT_EQ(out.refusals, 0);
  ASSERT_TRUE(out.alignment);
  EXPECT_LT(out.alignment->state.gyro_bias.norm(), 5.0 * 4e-4);
}

TEST(StaticAlignment, StandstillGyroBiasOfARecording) {
  test::Random random(8);
  Imu imu = noisy(random.direction());
  imu.gyro_bias = Vector3d(0.005, -0.004, 0.003);  // too small for a turn
  imu.motion = [](double t, ImuSample& s) {
    if (t < 1.0) s.gyro_B.x() += 1.0;
  };
  std::vector<ImuSample> samples;
  samples.reserve(700);
  for (int i = 0; i < 700; ++i) samples.push_back(imu.sample(i, random));
  const Options options;
  EXPECT_FALSE(standstill_gyro_bias(samples, samples[0].time, options));    // moves at first
  EXPECT_FALSE(standstill_gyro_bias(samples, samples[500].time, options));  // too short
  const auto bias = standstill_gyro_bias(samples, samples[200].time, options);
  ASSERT_TRUE(bias);
  // 4e-4 / sqrt(1.5) = 3.3e-4 rad/s an axis
  EXPECT_LT((*bias - imu.gyro_bias).cwiseAbs().maxCoeff(), 4.0 * 3.3e-4);
  samples.resize(460);
  EXPECT_FALSE(standstill_gyro_bias(samples, samples[200].time, options));
}

}  // namespace
}  // namespace rio

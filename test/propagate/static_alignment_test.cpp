// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/static_alignment.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "propagate/standing_imu.hpp"
#include "support/measured.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

TEST(StaticAlignment, RecoversTiltAndGyroBiasInAnyMounting) {
  using namespace body;
  const StartOptions start{.sigma_position = 0.2, .sigma_yaw = 0.3};
  Random random(1);
  for (int run = 0; run < 60; ++run) {
    StandingImu imu;
    const Vector3d special[] = {Vector3d::UnitZ(),  -Vector3d::UnitZ(), Vector3d::UnitX(),
                                -Vector3d::UnitX(), Vector3d::UnitY(),  -Vector3d::UnitY()};
    imu.up_B = run < 6 ? special[run] : random.direction();
    // across the vertical any bias is one; a rate about it might be a turn
    const Vector3d bias = random.uniform(0.0, 0.09) * random.direction();
    imu.gyro_bias = bias - 0.9 * bias.dot(imu.up_B) * imu.up_B;
    imu.accel_bias = 0.1 * imu.up_B;
    const Outcome out = align(imu, random, start);
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
    // scalar update with the prior 0.05, noise of 4e-3 over 1.5 s and 0.02 of local gravity
    const double gain = 0.05 * 0.05 / (0.05 * 0.05 + 4e-3 * 4e-3 / 1.5 + 0.02 * 0.02);
    EXPECT_LT((x.accel_bias - gain * imu.accel_bias).norm(), 1e-12);
    EXPECT_EQ(x.p_WB, Vector3d::Zero());
    EXPECT_EQ(x.v_WB, Vector3d::Zero());
    const BodyCovariance& P = out.alignment->covariance;
    EXPECT_LT((P - P.transpose()).cwiseAbs().maxCoeff(), 1e-17);
    EXPECT_TRUE(is_positive_definite(P));
    EXPECT_NEAR(imu.up_B.dot(P.block<3, 3>(kAttitude, kAttitude) * imu.up_B), 0.3 * 0.3, 1e-12);
    EXPECT_LT((P.diagonal().segment<3>(kPosition).array() - 0.2 * 0.2).abs().maxCoeff(), 1e-15);
    if (std::abs(imu.up_B.x()) > 0.99) continue;
    // no heading: x of the body lies above x of the world
    const Vector3d forward = x.q_WB * Vector3d::UnitX();
    EXPECT_NEAR(forward.y(), 0.0, 1e-12);
    EXPECT_GT(forward.x(), 0.0);
  }
}

// Refused while it moves, with each part of a window from the end of the first one on; aligned in
// the first window at rest, which begins with the first part at rest.
TEST(StaticAlignment, RefusesMotionAndRecovers) {
  Random random(6);
  const Vector3d up = random.direction();
  const Vector3d level = up.unitOrthogonal();
  const auto wave = [](double t) { return std::sin(2.0 * M_PI * 7.0 * t); };
  const std::pair<const char*, std::function<void(double t, ImuSample& s)>> motions[] = {
      {"shaking", [&](double t, ImuSample& s) { s.accel_B += 2.0 * wave(t) * level; }},
      {"rocking", [&](double t, ImuSample& s) { s.gyro_B += 0.2 * wave(t) * level; }},
      {"turning about the vertical", [&](double, ImuSample& s) { s.gyro_B += 0.3 * up; }},
      {"tilting at 3 deg/s",
       [&](double t, ImuSample& s) {
         const double rate = 3.0 * M_PI / 180.0;
         s.gyro_B += rate * level;
         s.accel_B += kGravity * (rotation_of(-rate * t * level) * up - up);
       }},
      {"accelerating upwards", [&](double, ImuSample& s) { s.accel_B += 1.0 * up; }},
      // from rest and back within each window; a constant one would be a tilt to any IMU
      {"starting forwards",
       [&](double t, ImuSample& s) {
         if (std::fmod(t, 301.0 / kRate) > 0.3) s.accel_B += 1.0 * level;
       }},
  };
  for (const auto& [what, motion] : motions) {
    SCOPED_TRACE(what);
    StandingImu imu = noisy(up);
    imu.motion = motion;
    StaticAligner aligner(StartOptions{}, ImuOptions{});
    const Outcome moving = align(aligner, imu, random, 0, 3 * 301);
    EXPECT_FALSE(moving.alignment);
    EXPECT_EQ(moving.refusals, 13);  // 1.5 s, 1.75 s .. 4.5 s
    imu.motion = nullptr;
    const Outcome still = align(aligner, imu, random, moving.samples, 351);
    EXPECT_TRUE(still.alignment);
    EXPECT_LE(still.refusals, 6);
    EXPECT_GT(still.samples, 280);  // hardly any motion in it
  }
}

// A platform that turns by itself: either hypothesis must stay within three sigmas, and the sigma
// of rates that biases have stays small.
TEST(StaticAlignment, SlowTurnIsNoSureBias) {
  for (const double rate : {0.002, 0.01, 0.02, 0.03, 0.04, 0.05, 0.09}) {
    Random random(10);
    StandingImu imu = noisy(random.direction());
    imu.gyro_bias = rate * imu.up_B;
    const Outcome out = align(imu, random);
    ASSERT_TRUE(out.alignment) << rate;
    EXPECT_EQ(out.refusals, 0) << rate;
    const Vector3d y = out.alignment->state.q_WB.conjugate() * Vector3d::UnitZ();
    const auto sigma_along = [&](const Vector3d& axis) {
      return std::sqrt(
          axis.dot(out.alignment->covariance.block<3, 3>(body::kGyroBias, body::kGyroBias) * axis));
    };
    const double sigma = sigma_along(y);
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
      measured("alignment at 0.05 rad/s of yaw: bias [rad/s]", bias, "below 3 sigma");
      measured("alignment at 0.05 rad/s of yaw: sigma [rad/s]", sigma, "");
    }
    EXPECT_LT(sigma_along(y.unitOrthogonal()), 1e-3);  // nothing is lost across the vertical
  }
}

// Switched on at rest and soon moved: the rest of the first window is used, with a larger sigma.
TEST(StaticAlignment, ShortRestIsEnoughInTheFirstWindowOnly) {
  const auto bias_variance = [](const Outcome& out) {
    return out.alignment->covariance(body::kGyroBias, body::kGyroBias);
  };
  const auto still_for = [](double rest, double shaken_before) {
    StandingImu imu = noisy(Vector3d::UnitZ());
    imu.motion = [=](double t, ImuSample& s) {
      const bool shakes = t < shaken_before || t >= shaken_before + rest;
      if (shakes) s.accel_B.x() += 4.0 * std::sin(40.0 * t);
    };
    return imu;
  };
  const auto begin = [](const StandingImu& imu, int count = 400) {
    Random random(8);
    StaticAligner aligner(StartOptions{}, ImuOptions{});
    return align(aligner, imu, random, 0, count);
  };
  const Outcome whole = begin(still_for(2.0, 0.0));
  const Outcome part = begin(still_for(1.2, 0.0));
  const Outcome third = begin(still_for(0.7, 0.0));
  ASSERT_TRUE(whole.alignment && part.alignment && third.alignment);
  EXPECT_EQ(part.alignment->state.time, Time(101'000'000'000));  // two thirds of 1.5 s
  EXPECT_EQ(third.alignment->state.time, Time(100'500'000'000));
  EXPECT_LT(part.alignment->state.gyro_bias.norm(), 5.0 * 4e-4);
  EXPECT_GT(bias_variance(part), bias_variance(whole));
  EXPECT_GT(bias_variance(third), bias_variance(part));
  EXPECT_FALSE(begin(still_for(0.4, 0.0)).alignment);
  StandingImu humming = still_for(0.8, 0.0);  // an engine hides slow motion
  humming.gyro_sigma = 0.02;
  EXPECT_FALSE(begin(humming).alignment);
  EXPECT_FALSE(begin(still_for(1.2, 2.0), 1000).alignment);  // no first window
}

TEST(StaticAlignment, ResetForgetsTheWindow) {
  Random random(7);
  StandingImu moving = noisy(Vector3d::UnitZ());
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
  Random random(8);
  StandingImu imu = noisy(random.direction());
  imu.gyro_bias = Vector3d(0.005, -0.004, 0.003);  // too small for a turn
  imu.motion = [](double t, ImuSample& s) {
    if (t < 1.0) s.gyro_B.x() += 1.0;
  };
  std::vector<ImuSample> samples;
  samples.reserve(700);
  for (int i = 0; i < 700; ++i) samples.push_back(imu.sample(i, random));
  const Options options;
  const auto bias_from = [&](std::size_t first) {
    const auto next = [&, i = std::size_t{0}](ImuSample* sample) mutable {
      if (i == samples.size()) return false;
      *sample = samples[i++];
      return true;
    };
    return standstill_gyro_bias(next, samples[first].time, options);
  };
  EXPECT_FALSE(bias_from(0));    // moves at first
  EXPECT_FALSE(bias_from(500));  // too short
  const auto bias = bias_from(200);
  ASSERT_TRUE(bias);
  // 4e-4 / sqrt(1.5) = 3.3e-4 rad/s an axis
  EXPECT_LT((*bias - imu.gyro_bias).cwiseAbs().maxCoeff(), 4.0 * 3.3e-4);
  samples.resize(460);
  EXPECT_FALSE(bias_from(200));
}

}  // namespace
}  // namespace rio::test

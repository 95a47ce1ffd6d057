// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/imu.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rio::sim {
namespace {

Trajectory::Point standing() {
  return Trajectory().at(0.0);
}

TEST(Imu, NoiseFreeIsTheExactMotion) {
  const Trajectory trajectory = indoor_flight(4, 30.0);
  ImuSimulator imu(ImuModel::noise_free(), 4);
  for (double t = 0.0; t < 20.0; t += 0.1) {
    const Trajectory::Point point = trajectory.at(t);
    const ImuSample sample = imu.sample(point);
    EXPECT_EQ(sample.gyro_B, point.gyro_B);
    EXPECT_EQ(sample.accel_B, point.accel_B);
    EXPECT_EQ(sample.time, point.nav.time);
  }
}

TEST(Imu, WhiteNoiseHasItsDensity) {
  ImuModel model = ImuModel::ideal();
  model.gyro_random_walk = model.accel_random_walk = 0.0;
  ImuSimulator imu(model, 1);
  const Vector3d gyro_bias = imu.gyro_bias();
  const Vector3d accel_bias = imu.accel_bias();
  constexpr int kSamples = 100000;
  Vector3d gyro = Vector3d::Zero();
  Vector3d accel = Vector3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const ImuSample sample = imu.sample(standing());
    gyro += (sample.gyro_B - gyro_bias).cwiseAbs2();
    accel += (sample.accel_B - Vector3d(0.0, 0.0, 9.81) - accel_bias).cwiseAbs2();
  }
  for (int axis = 0; axis < 3; ++axis) {
    // sqrt(200 Hz) = 14.142; five standard errors of a standard deviation are 1.1 %
    EXPECT_NEAR(std::sqrt(gyro[axis] / kSamples), 2e-4 * 14.142, 0.011 * 2e-4 * 14.142);
    EXPECT_NEAR(std::sqrt(accel[axis] / kSamples), 2e-3 * 14.142, 0.011 * 2e-3 * 14.142);
  }
  EXPECT_EQ(imu.gyro_bias(), gyro_bias);
}

TEST(Imu, BiasesStartAndWalkAsSpecified) {
  constexpr int kUnits = 400;
  constexpr int kSamples = 400;  // 2 s
  double gyro_start = 0.0;
  double accel_start = 0.0;
  double gyro_walk = 0.0;
  double accel_walk = 0.0;
  for (int seed = 0; seed < kUnits; ++seed) {
    ImuSimulator imu(ImuModel::ideal(), static_cast<std::uint64_t>(seed));
    const Vector3d gyro_bias = imu.gyro_bias();
    const Vector3d accel_bias = imu.accel_bias();
    for (int i = 0; i < kSamples; ++i) imu.sample(standing());
    gyro_start += gyro_bias.squaredNorm();
    accel_start += accel_bias.squaredNorm();
    gyro_walk += (imu.gyro_bias() - gyro_bias).squaredNorm();
    accel_walk += (imu.accel_bias() - accel_bias).squaredNorm();
  }
  const double n = 3.0 * kUnits;
  constexpr double kTolerance = 0.10;  // five standard errors of 1200 values
  EXPECT_NEAR(std::sqrt(gyro_start / n) / 5e-3, 1.0, kTolerance);
  EXPECT_NEAR(std::sqrt(accel_start / n) / 5e-2, 1.0, kTolerance);
  EXPECT_NEAR(std::sqrt(gyro_walk / n) / (2e-5 * std::sqrt(2.0)), 1.0, kTolerance);
  EXPECT_NEAR(std::sqrt(accel_walk / n) / (2e-4 * std::sqrt(2.0)), 1.0, kTolerance);
}

TEST(Imu, RecordedBiasIsTheOneInTheSample) {
  ImuModel model = ImuModel::ideal();
  model.gyro_noise_density = model.accel_noise_density = 0.0;
  ImuSimulator imu(model, 9);
  for (int i = 0; i < 10; ++i) {
    const Vector3d gyro_bias = imu.gyro_bias();
    const Vector3d accel_bias = imu.accel_bias();
    const ImuSample sample = imu.sample(standing());
    EXPECT_EQ(sample.gyro_B, gyro_bias);
    EXPECT_EQ(sample.accel_B, Vector3d(Vector3d(0.0, 0.0, 9.81) + accel_bias));
    EXPECT_NE(imu.gyro_bias(), gyro_bias);
  }
}

TEST(Imu, VibratesInFlightOnly) {
  ImuModel model = ImuModel::noise_free();
  model.accel_vibration = 0.5;
  model.gyro_vibration = 0.05;
  ImuSimulator imu(model, 2);
  Trajectory::Point point = standing();
  EXPECT_EQ(imu.sample(point).accel_B, point.accel_B);
  point.flying = true;
  constexpr int kSamples = 20000;
  Vector3d mean = Vector3d::Zero();
  Vector3d squares = Vector3d::Zero();
  Vector3d gyro_squares = Vector3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const ImuSample sample = imu.sample(point);
    mean += (sample.accel_B - point.accel_B) / kSamples;
    squares += (sample.accel_B - point.accel_B).cwiseAbs2() / kSamples;
    gyro_squares += (sample.gyro_B - point.gyro_B).cwiseAbs2() / kSamples;
  }
  EXPECT_LT(mean.norm(), 1e-3);  // whole cycles cancel
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(squares[axis], 0.5 * 0.5 / 2.0, 1e-3);  // mean square of a sinusoid
    EXPECT_NEAR(gyro_squares[axis], 0.05 * 0.05 / 2.0, 1e-5);
  }
}

TEST(Imu, Saturates) {
  ImuModel model = ImuModel::noise_free();
  model.accel_limit = 5.0;
  model.gyro_limit = 1.0;
  ImuSimulator imu(model, 1);
  Trajectory::Point point = standing();
  point.gyro_B = Vector3d(-2.0, 0.5, 2.0);
  const ImuSample sample = imu.sample(point);
  EXPECT_EQ(sample.gyro_B, Vector3d(-1.0, 0.5, 1.0));
  EXPECT_EQ(sample.accel_B, Vector3d(0.0, 0.0, 5.0));
}

}  // namespace
}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/imu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "support/measured.hpp"
#include "support/statistics.hpp"

namespace rio::sim {
namespace {

Trajectory::Point standing() {
  return Trajectory().at(0.0);
}

TEST(Imu, BiasesStartAndWalkAsSpecified) {
  constexpr int kUnits = 400;
  constexpr int kSamples = 2000;  // 10 s
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
  EXPECT_NEAR(std::sqrt(gyro_walk / n) / (2e-5 * std::sqrt(10.0)), 1.0, kTolerance);
  EXPECT_NEAR(std::sqrt(accel_walk / n) / (2e-4 * std::sqrt(10.0)), 1.0, kTolerance);
}

// At any rate: then also the Allan deviation is that of the densities.
TEST(Imu, NoiseAndBiasStepsOfTheAxesAreIndependentAndWhite) {
  using Vector12d = Eigen::Matrix<double, 12, 1>;
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  constexpr int kSamples = 100000;
  for (const double rate_hz : {100.0, 200.0}) {
    SCOPED_TRACE(rate_hz);
    ImuModel model = ImuModel::ideal();
    model.rate_hz = rate_hz;
    ImuSimulator imu(model, 4);
    const double root_rate = std::sqrt(rate_hz);
    Matrix12d squares = Matrix12d::Zero();
    Matrix12d neighbours = Matrix12d::Zero();
    Vector12d last = Vector12d::Zero();
    for (int i = 0; i < kSamples; ++i) {
      const Vector3d gyro_bias = imu.gyro_bias();
      const Vector3d accel_bias = imu.accel_bias();
      const ImuSample sample = imu.sample(standing());
      Vector12d e;
      e << (sample.gyro_B - gyro_bias) / (2e-4 * root_rate),
          (sample.accel_B - standing().accel_B - accel_bias) / (2e-3 * root_rate),
          (imu.gyro_bias() - gyro_bias) / (2e-5 / root_rate),
          (imu.accel_bias() - accel_bias) / (2e-4 / root_rate);
      squares += e * e.transpose() / kSamples;
      neighbours += e * last.transpose() / kSamples;
      last = e;
    }
    // five standard errors: 0.022 of a variance, 0.016 of a correlation
    EXPECT_LT((squares - Matrix12d::Identity()).cwiseAbs().maxCoeff(), 0.022);
    EXPECT_LT(neighbours.cwiseAbs().maxCoeff(), 0.016);
  }
}

TEST(Imu, VibrationHasItsAmplitudeAndItsFrequenciesInFlightOnly) {
  ImuModel model = ImuModel::noise_free();
  model.accel_vibration = 0.2;
  model.gyro_vibration = 0.01;
  model.vibration_frequency_hz = 70.0;
  ImuSimulator imu(model, 5);
  Trajectory::Point point = standing();
  EXPECT_EQ(imu.sample(point).accel_B, point.accel_B);
  point.flying = true;
  constexpr int kSamples = 20000;  // 100 s: whole cycles of 70, 72.1 and 74.2 Hz
  Eigen::Matrix<std::complex<double>, 6, 1> found =
      Eigen::Matrix<std::complex<double>, 6, 1>::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const ImuSample sample = imu.sample(point);
    for (int axis = 0; axis < 3; ++axis) {
      const double frequency = 70.0 * (1.0 + 0.03 * axis);
      const double angle = 2.0 * std::numbers::pi * frequency * i / 200.0;
      const std::complex<double> wave = std::polar(2.0 / kSamples, -angle);
      found[axis] += sample.gyro_B[axis] * wave;
      found[3 + axis] += sample.accel_B[axis] * wave;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    // phases of whole cycles: rounding only
    EXPECT_NEAR(std::abs(found[axis]), 0.01, 1e-9);
    EXPECT_NEAR(std::abs(found[3 + axis]), 0.2, 1e-9);
    // phases are random: no two channels move together
    for (int other = 0; other < 3 + axis; ++other) {
      EXPECT_GT(std::abs(std::arg(found[3 + axis] / found[other])), 1e-3);
    }
  }
}

/// Shaking alone, at 10 Hz and 60 Hz, the latter beyond half the rate of 100 Hz.
ImuModel shaking() {
  ImuModel model = ImuModel::noise_free();
  model.rate_hz = 100.0;
  model.low = {.frequency_hz = 10.0,
               .width_hz = 1.0,
               .gyro_rest = 0.01,
               .gyro_moving = 0.05,
               .accel_rest = 0.1,
               .accel_moving = 2.0};
  model.high = {.frequency_hz = 60.0, .width_hz = 1.0, .accel_moving = 3.0};
  return model;
}

/// What the IMU adds to the motion at a speed: rms of the gyroscope, and the y axis of the
/// accelerometer.
struct Shaken {
  double gyro_rms = 0.0;
  std::vector<double> accel;
};
Shaken shaken(const ImuModel& model, double speed, std::size_t count) {
  ImuSimulator imu(model, 3);
  Trajectory::Point point = standing();
  point.nav.v_WB.x() = speed;
  Shaken added;
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const ImuSample sample = imu.sample(point);
    added.accel.push_back(sample.accel_B.y());
    squares += sample.gyro_B.squaredNorm() / 3.0;
  }
  added.gyro_rms = std::sqrt(squares / static_cast<double>(count));
  return added;
}

TEST(Imu, ShakesAtRestAndInMotionByItsRms) {
  const struct {
    double speed, gyro, accel;
  } cases[] = {{0.0, 0.01, 0.1},
               {5.0, 0.05, std::hypot(2.0, 3.0)},
               // half the speed: (E4)
               {0.5, std::sqrt(1e-4 + 0.25 * (25e-4 - 1e-4)),
                std::sqrt(0.01 + 0.25 * (4.0 - 0.01) + 0.25 * 9.0)}};
  for (const auto& [speed, gyro, accel] : cases) {
    SCOPED_TRACE(speed);
    // noise 2 pi wide a second decorrelates in 0.16 s: 1 % of an rms in 2000 s is three sigmas
    const Shaken added = shaken(shaking(), speed, 200000);
    const double share = test::rms_of(added.accel) / accel;
    test::expect_near("accelerometer, of what is asked for", share, 1.0, 0.02);
    EXPECT_NEAR(added.gyro_rms / gyro, 1.0, 0.02);
  }
}

TEST(Imu, ShakesAroundItsFrequenciesAndTheirAliases) {
  constexpr std::size_t kWindow = 500;  // lines of 0.2 Hz
  constexpr std::size_t kWindows = 400;
  const std::vector<double> x = shaken(shaking(), 5.0, kWindow * kWindows).accel;
  const auto power = [&](double low, double high) {
    double sum = 0.0;
    for (std::size_t k = 1; k < kWindow / 2; ++k) {
      const double frequency = static_cast<double>(k) * 100.0 / kWindow;
      if (frequency < low || frequency >= high) continue;
      for (std::size_t w = 0; w < kWindows; ++w) {
        std::complex<double> line = 0.0;
        for (std::size_t i = 0; i < kWindow; ++i) {
          const double angle = 2.0 * std::numbers::pi * static_cast<double>(k * i) / kWindow;
          line += x[w * kWindow + i] * std::polar(1.0, -angle);
        }
        sum += 2.0 * std::norm(line) / (static_cast<double>(kWindow * kWindow) * kWindows);
      }
    }
    return sum;
  };
  // of a line of half width 1 Hz, 2 / pi atan(3) = 0.795 lies within 3 Hz
  const double low = power(7.0, 13.0) / 4.0;
  const double alias = power(37.0, 43.0) / 9.0;
  test::expect_near("power within 3 Hz of 10 Hz, share", low, 0.80, 0.04);
  test::expect_near("power of 60 Hz within 3 Hz of 40 Hz, share", alias, 0.80, 0.04);
  EXPECT_LT(power(20.0, 30.0) / 13.0, 0.05);
}

TEST(Imu, TheGroundChangesButNotTheMeanSquare) {
  ImuModel model = shaking();
  model.shaking_spread = 0.4;
  const std::vector<double> x = shaken(model, 5.0, 400000).accel;
  EXPECT_NEAR(test::rms_of(x) / std::hypot(2.0, 3.0), 1.0, 0.05);
  const double kurtosis = test::array_of(x).pow(4).mean() / std::pow(test::rms_of(x), 4);
  // 3 exp(4 s^2) of a Gaussian whose logarithm of the rms has the spread s
  test::expect_near("kurtosis at a spread of 0.4", kurtosis, 3.0 * std::exp(4.0 * 0.16), 0.6);
}

TEST(Losses, HaveTheirShareAndTheirRuns) {
  for (const double run : {1.0, 4.0}) {
    Losses losses({.lost_share = 0.3, .lost_run = run}, 1);
    double lost = 0.0;
    double runs = 0.0;
    bool before = false;
    constexpr int kSamples = 100000;
    for (int i = 0; i < kSamples; ++i) {
      const bool now = losses.next();
      lost += now ? 1.0 : 0.0;
      runs += now && !before ? 1.0 : 0.0;
      before = now;
    }
    test::expect_near("share lost in runs of " + std::to_string(run), lost / kSamples, 0.3, 0.01);
    EXPECT_NEAR(lost / runs, run, 0.03 * run);
  }
}

}  // namespace
}  // namespace rio::sim

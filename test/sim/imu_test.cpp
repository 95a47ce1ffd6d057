// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/imu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "rio/sim/path.hpp"
#include "support/measured.hpp"

namespace rio::sim {
namespace {

Trajectory::Point standing() {
  return Trajectory().at(0.0);
}

TEST(Imu, NoiseFreeIsTheExactMotion) {
  const Trajectory trajectory = random_flight(4, {.length = 30.0});
  ImuSimulator imu(ImuModel::noise_free(), 4);
  for (double t = 0.0; t < 20.0; t += 0.1) {
    const Trajectory::Point point = trajectory.at(t);
    const ImuSample sample = imu.sample(point);
    EXPECT_EQ(sample.gyro_B, point.gyro_B);
    EXPECT_EQ(sample.accel_B, point.accel_B);
    EXPECT_EQ(sample.time, point.nav.time);
  }
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

/// Allan deviation of samples at `rate_hz` for clusters of `seconds` (IEEE Std 952).
double allan_deviation(const std::vector<double>& samples, double rate_hz, double seconds) {
  const auto size = static_cast<std::size_t>(seconds * rate_hz);
  std::vector<double> means;
  for (std::size_t i = 0; i + size <= samples.size(); i += size) {
    const auto first = samples.begin() + static_cast<std::ptrdiff_t>(i);
    const double sum = std::accumulate(first, first + static_cast<std::ptrdiff_t>(size), 0.0);
    means.push_back(sum / static_cast<double>(size));
  }
  double squares = 0.0;
  for (std::size_t i = 1; i < means.size(); ++i) {
    squares += (means[i] - means[i - 1]) * (means[i] - means[i - 1]);
  }
  return std::sqrt(0.5 * squares / static_cast<double>(means.size() - 1));
}

TEST(Imu, AllanDeviationShowsDensityAndRandomWalk) {
  for (const double rate_hz : {100.0, 200.0}) {
    ImuModel model = ImuModel::ideal();
    model.rate_hz = rate_hz;
    model.gyro_random_walk = 2e-3;  // so that the walk rules at 10 s and the noise at 0.1 s
    model.accel_random_walk = 2e-2;
    ImuSimulator imu(model, 7);
    std::vector<double> gyro;
    std::vector<double> accel;
    for (int i = 0; i < static_cast<int>(6000.0 * rate_hz); ++i) {
      const ImuSample sample = imu.sample(standing());
      gyro.push_back(sample.gyro_B.y());
      accel.push_back(sample.accel_B.z());
    }
    const auto expected = [](double density, double walk, double seconds) {
      return std::sqrt(density * density / seconds + walk * walk * seconds / 3.0);
    };
    // five standard errors: of 60000 clusters 2 %, of 600 clusters 20 %
    EXPECT_NEAR(allan_deviation(gyro, rate_hz, 0.1) / expected(2e-4, 2e-3, 0.1), 1.0, 0.02);
    EXPECT_NEAR(allan_deviation(accel, rate_hz, 0.1) / expected(2e-3, 2e-2, 0.1), 1.0, 0.02);
    EXPECT_NEAR(allan_deviation(gyro, rate_hz, 10.0) / expected(2e-4, 2e-3, 10.0), 1.0, 0.20);
    EXPECT_NEAR(allan_deviation(accel, rate_hz, 10.0) / expected(2e-3, 2e-2, 10.0), 1.0, 0.20);
  }
}

TEST(Imu, BiasIncrementsAreWhite) {
  ImuModel model = ImuModel::ideal();
  ImuSimulator imu(model, 3);
  constexpr int kSamples = 50000;
  Matrix3d squares = Matrix3d::Zero();
  Vector3d neighbours = Vector3d::Zero();
  Vector3d last = Vector3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Vector3d before = imu.accel_bias();
    imu.sample(standing());
    const Vector3d step = imu.accel_bias() - before;
    squares += step * step.transpose() / kSamples;
    neighbours += step.cwiseProduct(last) / kSamples;
    last = step;
  }
  // five standard errors of 50000 values: 1.6 % of a standard deviation, 0.022 of a correlation
  const double variance = 2e-4 * 2e-4 / 200.0;
  EXPECT_LT((squares / variance - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.032);
  EXPECT_LT((neighbours / variance).cwiseAbs().maxCoeff(), 0.022);
}

TEST(Imu, NoiseOfTheAxesIsIndependentAndWhite) {
  ImuModel model = ImuModel::ideal();
  model.gyro_random_walk = model.accel_random_walk = 0.0;
  ImuSimulator imu(model, 4);
  const Vector3d gyro_bias = imu.gyro_bias();
  const Vector3d still = standing().accel_B + imu.accel_bias();
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  constexpr int kSamples = 100000;
  Matrix6d squares = Matrix6d::Zero();
  Matrix6d neighbours = Matrix6d::Zero();
  Vector6d last = Vector6d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const ImuSample sample = imu.sample(standing());
    Vector6d noise;
    noise << (sample.gyro_B - gyro_bias) / 2e-4, (sample.accel_B - still) / 2e-3;
    noise /= std::sqrt(200.0);
    squares += noise * noise.transpose() / kSamples;
    neighbours += noise * last.transpose() / kSamples;
    last = noise;
  }
  // five standard errors: 0.022 of a variance, 0.016 of a correlation
  EXPECT_LT((squares - Matrix6d::Identity()).cwiseAbs().maxCoeff(), 0.022);
  EXPECT_LT(neighbours.cwiseAbs().maxCoeff(), 0.016);
  EXPECT_EQ(imu.gyro_bias(), gyro_bias);
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

/// What the IMU adds to the motion at a speed, y axis of the accelerometer; the rms of the
/// gyroscope.
std::vector<double> shaken(const ImuModel& model, double speed, std::size_t count, double* gyro) {
  ImuSimulator imu(model, 3);
  Trajectory::Point point = standing();
  point.nav.v_WB.x() = speed;
  std::vector<double> accel;
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const ImuSample sample = imu.sample(point);
    accel.push_back(sample.accel_B.y());
    squares += sample.gyro_B.squaredNorm() / 3.0;
  }
  *gyro = std::sqrt(squares / static_cast<double>(count));
  return accel;
}

double root_mean_square(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += value * value;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

TEST(Imu, ShakesAtRestAndInMotionByItsRms) {
  constexpr std::size_t kSamples = 200000;
  // noise 2 pi wide a second decorrelates in 0.16 s: 1 % of an rms in 2000 s is three sigmas
  double gyro = 0.0;
  const double rest = root_mean_square(shaken(shaking(), 0.0, kSamples, &gyro));
  test::measured("accelerometer at rest, of 0.1 [m/s^2]", rest, "within 2 %");
  EXPECT_NEAR(rest / 0.1, 1.0, 0.02);
  EXPECT_NEAR(gyro / 0.01, 1.0, 0.02);
  const double moving = root_mean_square(shaken(shaking(), 5.0, kSamples, &gyro));
  const double both = std::hypot(2.0, 3.0);
  test::measured("in motion, of 3.61 [m/s^2]", moving, "within 2 %");
  EXPECT_NEAR(moving / both, 1.0, 0.02);
  EXPECT_NEAR(gyro / 0.05, 1.0, 0.02);
  // half the speed: (E4)
  const double half = root_mean_square(shaken(shaking(), 0.5, kSamples, &gyro));
  const double square = 0.01 + 0.25 * (4.0 - 0.01) + 0.25 * 9.0;
  EXPECT_NEAR(half / std::sqrt(square), 1.0, 0.02);
}

TEST(Imu, ShakesAroundItsFrequenciesAndTheirAliases) {
  constexpr std::size_t kWindow = 500;  // lines of 0.2 Hz
  constexpr std::size_t kWindows = 400;
  double gyro = 0.0;
  const std::vector<double> x = shaken(shaking(), 5.0, kWindow * kWindows, &gyro);
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
  test::measured("power within 3 Hz of 10 Hz, share", low, "0.80 within 0.04");
  test::measured("power of 60 Hz within 3 Hz of 40 Hz, share", alias, "0.80 within 0.04");
  EXPECT_NEAR(low, 0.80, 0.04);
  EXPECT_NEAR(alias, 0.80, 0.04);
  EXPECT_LT(power(20.0, 30.0) / 13.0, 0.05);
}

TEST(Imu, TheGroundChangesButNotTheMeanSquare) {
  ImuModel model = shaking();
  model.shaking_spread = 0.4;
  double gyro = 0.0;
  const std::vector<double> x = shaken(model, 5.0, 400000, &gyro);
  EXPECT_NEAR(root_mean_square(x) / std::hypot(2.0, 3.0), 1.0, 0.05);
  double fourth = 0.0;
  for (const double value : x) fourth += std::pow(value, 4) / static_cast<double>(x.size());
  const double kurtosis = fourth / std::pow(root_mean_square(x), 4);
  // 3 exp(4 s^2) of a Gaussian whose logarithm of the rms has the spread s
  test::measured("kurtosis at a spread of 0.4", kurtosis, "5.7 within 0.6");
  EXPECT_NEAR(kurtosis, 3.0 * std::exp(4.0 * 0.16), 0.6);
}

TEST(Losses, HaveTheirShareAndTheirRuns) {
  for (const double run : {1.0, 4.0}) {
    ImuModel model;
    model.lost_share = 0.3;
    model.lost_run = run;
    Losses losses(model, 1);
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
    test::measured("share lost in runs of " + std::to_string(run), lost / kSamples,
                   "0.30 within 0.01");
    EXPECT_NEAR(lost / kSamples, 0.3, 0.01);
    EXPECT_NEAR(lost / runs, run, 0.03 * run);
  }
}

}  // namespace
}  // namespace rio::sim

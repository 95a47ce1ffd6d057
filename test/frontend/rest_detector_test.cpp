// SPDX-License-Identifier: BSD-3-Clause
// True rest against everything that looks like it: hovering, constant velocity, slow turns, hands.
#include "rio/frontend/rest_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "rio/sim/imu.hpp"
#include "rio/sim/random.hpp"

namespace rio::test {
namespace {

using Rest = std::optional<RestModel::Measurement>;

constexpr Time kScanPeriod = std::chrono::milliseconds(66);

/// A body at one place, or in steady motion, with an IMU and a radar that looks ahead.
class RestDetectorTest : public testing::Test {
 protected:
  RestDetectorTest() {
    options_.imu.gyro_noise_density = model_.gyro_noise_density;
    options_.imu.accel_noise_density = model_.accel_noise_density;
    options_.timing.imu_buffer = 100000;  // the whole test
    motion_.accel_B = Vector3d(0.0, 0.0, options_.imu.gravity);
    restart();
  }
  void restart() {
    imu_ = ImuBuffer(options_.timing, options_.imu);
    simulator_.emplace(model_, 21);
    detector_.emplace(options_);
    scan_.time = last_ = Time{0};
    motion_.nav.time = Time{0};
  }

  /// The next scan, `pause` after the last one: what moves has the velocity v_S in radar axes.
  Rest next(Time pause = kScanPeriod) {
    scan_.time += pause;
    while (motion_.nav.time <= scan_.time) {
      imu_.push_back(simulator_->sample(motion_));
      motion_.nav.time += from_seconds(1.0 / model_.rate_hz);
    }
    scan_.items.clear();
    for (int i = 0; i < detections_; ++i) {
      RadarDetection raw;
      raw.point_S = Vector3d(3.0, random_.uniform(-2.0, 2.0), random_.uniform(-1.0, 1.0));
      const double v = i < movers_ ? 1.0 : raw.point_S.normalized().dot(v_S_);
      raw.range_rate = -v + options_.radar.sigma_doppler * random_.normal();
      const double grid = options_.radar.doppler_resolution;
      if (grid > 0.0) raw.range_rate = grid * std::round(raw.range_rate / grid);
      scan_.items.push_back(make_detection(raw, options_.radar));
    }
    Rest rest = detector_->observe(scan_, last_, imu_, known(scan_.time), covariance_);
    last_ = scan_.time;
    return rest;
  }
  /// What the filter has learnt during alignment.
  Vector3d known_bias() const { return simulator_->gyro_bias() + bias_error_; }
  NavState known(Time time) const {
    NavState x;
    x.time = time;
    x.gyro_bias = known_bias();
    x.accel_bias = simulator_->accel_bias();
    return x;
  }
  /// Scans out of `count` that were called rest.
  int rests(int count) {
    int sum = 0;
    for (int i = 0; i < count; ++i) sum += next() ? 1 : 0;
    return sum;
  }

  /// The gyroscope was quiet enough to measure its bias.
  static bool measures_rate(const RestModel::Measurement& rest) { return rest.sigma_rate < 1.0; }

  sim::ImuModel model_;
  Options options_;
  sim::Trajectory::Point motion_;  ///< stands, unless a test says otherwise
  Vector3d v_S_ = Vector3d::Zero();
  Vector3d bias_error_ = Vector3d::Zero();
  BodyCovariance covariance_ = 1e-6 * BodyCovariance::Identity();  ///< after an alignment
  int detections_ = 30;
  int movers_ = 0;
  ImuBuffer imu_{options_.timing, options_.imu};
  std::optional<sim::ImuSimulator> simulator_;
  std::optional<RestDetector> detector_;
  sim::Random random_{22, 0};
  DetectionList scan_;
  Time last_{0};
};

TEST_F(RestDetectorTest, OnTheGroundAfterHalfASecond) {
  for (int i = 0; i <= 7; ++i) EXPECT_FALSE(next()) << i;  // 7 * 66 ms = 0.46 s
  EXPECT_EQ(rests(300), 300);
}

TEST_F(RestDetectorTest, MeasuresZeroVelocityAndTheBias) {
  Vector3d sum = Vector3d::Zero();
  double squares = 0.0;
  int count = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d bias = simulator_->gyro_bias();
    const Rest rest = next();
    if (!rest || !measures_rate(*rest)) continue;
    ++count;
    EXPECT_GT(rest->sigma_velocity, 0.0);
    EXPECT_LT(rest->sigma_velocity, 0.05);
    // white noise averaged over 66 ms
    EXPECT_NEAR(rest->sigma_rate, model_.gyro_noise_density / std::sqrt(0.066), 1e-9);
    const Vector3d error = (rest->gyro_B - bias) / rest->sigma_rate;
    sum += error;
    squares += error.squaredNorm();
  }
  ASSERT_GT(count, 250);
  // mean 0 and variance 1 of three times so many values, within four standard deviations
  EXPECT_LT(sum.cwiseAbs().maxCoeff() / count, 4.0 / std::sqrt(count));
  EXPECT_NEAR(squares / (3.0 * count), 1.0, 4.0 * std::sqrt(2.0 / (3.0 * count)));
}

TEST_F(RestDetectorTest, HoveringIsNoRest) {
  motion_.flying = true;  // the rotors shake: 0.2 m/s^2 and 0.01 rad/s
  EXPECT_EQ(rests(300), 0);
}

TEST_F(RestDetectorTest, ShakingOfEitherSensorAloneIsNoRest) {
  motion_.flying = true;
  model_.gyro_vibration = 0.0;
  restart();
  EXPECT_EQ(rests(100), 0);
  model_ = sim::ImuModel{};
  model_.accel_vibration = 0.0;
  restart();
  EXPECT_EQ(rests(100), 0);
}

TEST_F(RestDetectorTest, CarriedAtConstantVelocityIsNoRest) {
  v_S_ = Vector3d(0.3, 0.0, 0.0);  // ten sigmas of the Doppler; the IMU cannot tell
  EXPECT_EQ(rests(300), 0);
}

TEST_F(RestDetectorTest, TurningIsNoRest) {
  motion_.gyro_B = Vector3d(0.0, 0.0, 0.05);  // rad/s, steady
  EXPECT_EQ(rests(300), 0);
}

// The other way round: a bias as wrong as that is no rest either, so nothing is learnt from it.
TEST_F(RestDetectorTest, AWrongBiasIsNoRest) {
  bias_error_ = Vector3d(0.0, 0.05, 0.0);
  EXPECT_EQ(rests(100), 0);
}

TEST_F(RestDetectorTest, ThreePointsAScanAreEnough) {
  detections_ = 3;
  for (int i = 0; i <= 7; ++i) EXPECT_FALSE(next()) << i;
  EXPECT_GT(rests(100), 95);
}

TEST_F(RestDetectorTest, NeedsDetections) {
  detections_ = 0;
  EXPECT_EQ(rests(100), 0);
}

TEST_F(RestDetectorTest, NeedsMostDetectionsToStand) {
  movers_ = 6;  // somebody walks by
  EXPECT_GT(rests(100), 90);
  restart();
  movers_ = 10;  // a third
  EXPECT_EQ(rests(100), 0);
}

// 5 cm/s is less than a Doppler tells, but all of them together tell it.
TEST_F(RestDetectorTest, CreepingIsNoRest) {
  v_S_ = Vector3d(0.05, 0.0, 0.0);
  EXPECT_EQ(rests(300), 0);
}

// The known limit: rounded to the same cell, they tell nothing.
TEST_F(RestDetectorTest, CreepingBelowTheCellPassesForRest) {
  options_.radar.doppler_resolution = 0.125;
  options_.radar.sigma_doppler = 0.005;
  restart();
  v_S_ = Vector3d(0.05, 0.0, 0.0);
  EXPECT_GT(rests(100), 90);
  v_S_ = Vector3d(0.1, 0.0, 0.0);
  EXPECT_EQ(rests(100), 0);
}

// A cell of half a metre per second hides the first second of any departure from the Doppler.
TEST_F(RestDetectorTest, SettingOffBelowACoarseCellIsNoRest) {
  options_.radar.doppler_resolution = 0.49;
  restart();
  ASSERT_GT(rests(30), 15);
  motion_.accel_B.x() = 0.3;
  for (int i = 0; i < 4; ++i) (void)next();  // 0.26 s, up to 0.08 m/s
  EXPECT_EQ(rests(11), 0);                   // up to 0.3 m/s
}

// A tilt that is not known as well explains the same force.
TEST_F(RestDetectorTest, AnUncertainTiltIsNoDeparture) {
  options_.radar.doppler_resolution = 0.49;
  restart();
  ASSERT_GT(rests(30), 15);
  motion_.accel_B.x() = 0.3;
  covariance_.block<3, 3>(body::kAttitude, body::kAttitude) = 1e-3 * Matrix3d::Identity();
  EXPECT_EQ(rests(15), 15);
}

// A fine Doppler sees a departure itself; a force without one is a touch.
TEST_F(RestDetectorTest, AForceUnderAFineDopplerIsNoDeparture) {
  options_.radar.doppler_resolution = 0.1;
  restart();
  ASSERT_GT(rests(30), 15);
  motion_.accel_B.x() = 0.3;
  EXPECT_EQ(rests(15), 15);
}

// After a drive the estimated tilt may be off by more than its covariance: a second of rest
// corrects it, and only then a force counts as a departure again.
TEST_F(RestDetectorTest, TheForceIsTestedFromSettledRestOn) {
  options_.radar.doppler_resolution = 0.49;
  restart();
  v_S_.x() = 2.0;
  EXPECT_EQ(rests(10), 0);
  v_S_.x() = 0.0;
  motion_.accel_B.x() = 0.3;
  EXPECT_EQ(rests(8), 0);    // half a second without Doppler first
  EXPECT_EQ(rests(15), 15);  // a second
  (void)rests(2);
  EXPECT_EQ(rests(20), 0);
}

// Set down and touched for a third of a second in every second. The gyroscope measures its bias
// between the touches alone.
TEST_F(RestDetectorTest, TouchedOnTheGroundIsRest) {
  int with_rate = 0;
  int count = 0;
  for (int i = 0; i < 150; ++i) {
    const bool touched = i % 15 < 5;
    motion_.gyro_B = touched ? Vector3d(0.0, 0.1, 0.05) : Vector3d::Zero();
    const Rest rest = next();
    if (i < 15 || !rest) continue;
    ++count;
    if (!measures_rate(*rest)) continue;
    ++with_rate;
    EXPECT_FALSE(touched);
    EXPECT_LT((rest->gyro_B - known_bias()).norm(), 4.0 * rest->sigma_rate);
  }
  EXPECT_EQ(count, 135);
  EXPECT_GT(with_rate, 70);
}

TEST_F(RestDetectorTest, HeldInAHandIsNoRest) {
  int count = 0;
  for (int i = 0; i < 150; ++i) {
    motion_.gyro_B = 0.1 * Vector3d(std::sin(0.7 * i), std::cos(0.7 * i), 0.0);
    count += next() ? 1 : 0;
  }
  EXPECT_EQ(count, 0);
}

TEST_F(RestDetectorTest, MotionBeginsAnew) {
  ASSERT_GT(rests(20), 0);
  v_S_.x() = 0.3;
  EXPECT_FALSE(next());
  v_S_.x() = 0.0;
  EXPECT_EQ(rests(8), 0);
  EXPECT_TRUE(next());
}

TEST_F(RestDetectorTest, ResetBeginsAnew) {
  ASSERT_GT(rests(20), 0);
  detector_->reset();
  EXPECT_EQ(rests(8), 0);
  EXPECT_TRUE(next());
}

TEST_F(RestDetectorTest, APauseOfTheRadarBeginsAnew) {
  ASSERT_GT(rests(20), 0);
  EXPECT_FALSE(next(std::chrono::milliseconds(600)));
  EXPECT_EQ(rests(8), 0);
  EXPECT_TRUE(next());
}

TEST_F(RestDetectorTest, WithoutImuSamplesThereIsNoRest) {
  ASSERT_GT(rests(20), 0);
  const Time silent = last_ + kScanPeriod;
  scan_.time = silent;
  EXPECT_FALSE(detector_->observe(scan_, last_, imu_, known(silent), covariance_));
}

TEST_F(RestDetectorTest, CanBeSwitchedOff) {
  options_.frontend.detect_rest = false;
  restart();
  EXPECT_EQ(rests(100), 0);
}

}  // namespace
}  // namespace rio::test

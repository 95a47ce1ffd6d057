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
constexpr int kHalfASecond = 8;  // scans at rest, the first one included, that are not called so

/// A body at one place, or in steady motion, with an IMU and a radar that looks ahead.
struct Body {
  Body() {
    options_.imu.gyro_noise_density = model_.gyro_noise_density;
    options_.imu.accel_noise_density = model_.accel_noise_density;
    options_.timing.imu_buffer = 100000;  // the whole test
    motion_.accel_B = Vector3d(0.0, 0.0, options_.imu.gravity);
    restart();
  }
  /// From the beginning, with the options and the sensors as they are now.
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
  NavState known(Time time) const {
    NavState x;
    x.time = time;
    x.gyro_bias = simulator_->gyro_bias() + bias_error_;
    x.accel_bias = simulator_->accel_bias();
    return x;
  }
  /// A radar of little noise and cells of 0.125 m/s, at a speed.
  void round_to_cells(double speed) {
    options_.radar.doppler_resolution = 0.125;
    options_.radar.sigma_doppler = 0.005;
    v_S_.x() = speed;
  }
  /// Scans out of `count` that were called rest.
  int rests(int count) {
    int sum = 0;
    for (int i = 0; i < count; ++i) sum += next() ? 1 : 0;
    return sum;
  }

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

/// The gyroscope was quiet enough to measure its bias.
bool measures_rate(const RestModel::Measurement& rest) {
  return rest.sigma_rate < 1.0;
}

class RestDetectorTest : public Body, public testing::Test {};

TEST(RestDetector, TellsRestFromWhatLooksLikeIt) {
  struct Scene {
    const char* name;
    int least;  ///< scans of 300 after half a second that are called rest; none at all if 0
    void (*set)(Body&);
  };
  for (const Scene& scene : {
           Scene{"on the ground", 300, [](Body&) {}},
           // the rotors shake: 0.2 m/s^2 and 0.01 rad/s
           Scene{"hovering", 0, [](Body& b) { b.motion_.flying = true; }},
           Scene{"shaking of the accelerometer alone", 0,
                 [](Body& b) {
                   b.motion_.flying = true;
                   b.model_.gyro_vibration = 0.0;
                 }},
           Scene{"shaking of the gyroscope alone", 0,
                 [](Body& b) {
                   b.motion_.flying = true;
                   b.model_.accel_vibration = 0.0;
                 }},
           // ten sigmas of the Doppler; the IMU cannot tell
           Scene{"carried at constant velocity", 0, [](Body& b) { b.v_S_.x() = 0.3; }},
           // less than a Doppler tells, but all of them together tell it
           Scene{"creeping", 0, [](Body& b) { b.v_S_.x() = 0.05; }},
           // the known limit: rounded to the same cell, they tell nothing
           Scene{"creeping below the cell", 297, [](Body& b) { b.round_to_cells(0.05); }},
           Scene{"above half a cell", 0, [](Body& b) { b.round_to_cells(0.1); }},
           Scene{"turning steadily", 0, [](Body& b) { b.motion_.gyro_B.z() = 0.05; }},
           // nothing is learnt from it
           Scene{"a bias as wrong as that", 0, [](Body& b) { b.bias_error_.y() = 0.05; }},
           Scene{"three points a scan", 288, [](Body& b) { b.detections_ = 3; }},
           Scene{"no points", 0, [](Body& b) { b.detections_ = 0; }},
           Scene{"somebody walks by", 297, [](Body& b) { b.movers_ = 6; }},
           Scene{"a third of the points moves", 0, [](Body& b) { b.movers_ = 10; }},
           Scene{"switched off", 0, [](Body& b) { b.options_.frontend.detect_rest = false; }},
       }) {
    SCOPED_TRACE(scene.name);
    Body body;
    scene.set(body);
    body.restart();
    EXPECT_EQ(body.rests(kHalfASecond), 0);
    const int rests = body.rests(300);
    EXPECT_GE(rests, scene.least);
    EXPECT_TRUE(rests == 0 || scene.least > 0) << rests;
  }
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

// A push of 0.3 m/s^2 is a departure where the Doppler hides the first second of it.
TEST(RestDetector, SetsOffAtAForceThatTheDopplerHides) {
  struct Row {
    double doppler_resolution;  ///< [m/s]
    double tilt_variance;       ///< [rad^2]
    bool rest;
  };
  for (const Row& row :
       {Row{0.49, 1e-6, false}, Row{0.49, 1e-3, true},  // such a tilt explains the same force
        Row{0.1, 1e-6, true}}) {  // a fine Doppler tells a departure from a touch
    SCOPED_TRACE(testing::Message() << row.doppler_resolution << " " << row.tilt_variance);
    Body body;
    body.options_.radar.doppler_resolution = row.doppler_resolution;
    body.covariance_.diagonal().segment<3>(body::kAttitude).setConstant(row.tilt_variance);
    body.restart();
    ASSERT_GT(body.rests(30), 15);
    body.motion_.accel_B.x() = 0.3;
    const int first = body.rests(4);  // 0.26 s, up to 0.08 m/s
    EXPECT_TRUE(first == 4 || !row.rest);
    EXPECT_EQ(body.rests(11), row.rest ? 11 : 0);  // up to 0.3 m/s
  }
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
  EXPECT_EQ(rests(kHalfASecond), 0);  // half a second without Doppler first
  EXPECT_EQ(rests(15), 15);           // a second
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
    EXPECT_LT((rest->gyro_B - simulator_->gyro_bias()).norm(), 4.0 * rest->sigma_rate);
  }
  EXPECT_EQ(count, 135);
  EXPECT_GT(with_rate, 70);
}

TEST_F(RestDetectorTest, HeldInAHandIsNoRest) {
  for (int i = 0; i < 150; ++i) {
    motion_.gyro_B = 0.1 * Vector3d(std::sin(0.7 * i), std::cos(0.7 * i), 0.0);
    EXPECT_FALSE(next()) << i;
  }
}

TEST(RestDetector, BeginsAnew) {
  struct Break {
    const char* after;
    void (*happens)(Body&);
  };
  for (const Break& b : {Break{"motion",
                               [](Body& body) {
                                 body.v_S_.x() = 0.3;
                                 EXPECT_FALSE(body.next());
                                 body.v_S_.x() = 0.0;
                               }},
                         Break{"a reset", [](Body& body) { body.detector_->reset(); }},
                         Break{"a pause of the radar", [](Body& body) {
                                 EXPECT_FALSE(body.next(std::chrono::milliseconds(600)));
                               }}}) {
    SCOPED_TRACE(b.after);
    Body body;
    ASSERT_GT(body.rests(20), 0);
    b.happens(body);
    EXPECT_EQ(body.rests(kHalfASecond), 0);
    EXPECT_TRUE(body.next());
  }
}

TEST_F(RestDetectorTest, WithoutImuSamplesThereIsNoRest) {
  ASSERT_GT(rests(20), 0);
  const Time silent = last_ + kScanPeriod;
  scan_.time = silent;
  EXPECT_FALSE(detector_->observe(scan_, last_, imu_, known(silent), covariance_));
}

}  // namespace
}  // namespace rio::test

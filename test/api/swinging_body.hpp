// SPDX-License-Identifier: BSD-3-Clause
// The odometry on a body that swings along x and sees a few points.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>

#include "experiment/trial.hpp"
#include "rio/rio.hpp"

namespace rio::test {

inline constexpr double kAmplitude = 0.5;  // [m]
inline constexpr double kRate = 4.0;       // [rad/s]
inline constexpr Time kStart = Time(10'000'000'000);
inline constexpr Time kSample = std::chrono::milliseconds(5);

inline NavState truth(Time t) {
  const double phase = kRate * to_seconds(t);
  return {.time = t,
          .p_WB = {kAmplitude * std::sin(phase), 0.0, 0.0},
          .v_WB = {kAmplitude * kRate * std::cos(phase), 0.0, 0.0}};
}

inline ImuSample imu(Time t) {
  const double accel = -kAmplitude * kRate * kRate * std::sin(kRate * to_seconds(t));
  return {t, {1e-6 * to_seconds(t), 0.0, 0.0}, {accel, 0.0, 9.81}};  // the gyro is not frozen
}

/// Measured at t, stamped `late` after that.
inline RadarScan scan(Time t, Time late = Time(0)) {
  RadarScan s;
  s.time = t + late;
  const NavState x = truth(t);
  for (const Vector3d& p_W :
       {Vector3d(5.0, 1.0, 0.5), Vector3d(4.0, -2.0, 1.0), Vector3d(6.0, 3.0, -1.0),
        Vector3d(3.0, 0.5, -1.0), Vector3d(4.0, 2.0, 1.5), Vector3d(7.0, -3.0, 0.3)}) {
    const Vector3d point_S = p_W - x.p_WB;
    s.detections.push_back({point_S, -point_S.normalized().dot(x.v_WB), 30.0});
  }
  return s;
}

class EngineTest : public testing::Test {
 protected:
  EngineTest() { options_.start.static_alignment = false; }
  std::unique_ptr<Odometry> started() const {
    auto odometry = experiment::create_odometry(options_);
    EXPECT_EQ(odometry->reset(truth(kStart), 1e-6 * BodyCovariance::Identity()), Status::kOk);
    return odometry;
  }
  /// Samples after the newest one up to `until`.
  void feed(Odometry& odometry, Time until) {
    for (; next_ <= until; next_ += kSample) {
      EXPECT_EQ(odometry.add_imu(imu(next_)), Status::kOk);
    }
  }
  /// With scans at 20 Hz, from the next sample on.
  void fly(Odometry& odometry, Time duration) {
    const Time end = next_ + duration;
    for (Time t = next_; t <= end; t += std::chrono::milliseconds(50)) {
      feed(odometry, t + kSample);  // a time offset of a microsecond needs it
      EXPECT_EQ(odometry.add_scan(scan(t)), Status::kOk) << to_seconds(t);
    }
  }

  Options options_;
  Time next_ = kStart;
};

}  // namespace rio::test

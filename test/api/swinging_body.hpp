// SPDX-License-Identifier: BSD-3-Clause
// The odometry on a body that swings along x and sees a few points.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include "rio/rio.hpp"

namespace rio::test {

inline constexpr double kAmplitude = 0.5;  // [m]
inline constexpr double kRate = 4.0;       // [rad/s]
inline constexpr Time kStart = Time(10'000'000'000);
inline constexpr Time kSample = std::chrono::milliseconds(5);

inline NavState truth(Time t) {
  const double phase = kRate * to_seconds(t);
  NavState x;
  x.time = t;
  x.p_WB.x() = kAmplitude * std::sin(phase);
  x.v_WB.x() = kAmplitude * kRate * std::cos(phase);
  return x;
}

inline ImuSample imu(Time t) {
  ImuSample s;
  s.time = t;
  s.accel_B = Vector3d(-kAmplitude * kRate * kRate * std::sin(kRate * to_seconds(t)), 0.0, 9.81);
  s.gyro_B.x() = 1e-6 * to_seconds(t);  // not frozen
  return s;
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
    std::string why;
    auto odometry = Odometry::create(options_, &why);
    EXPECT_NE(odometry, nullptr) << why;
    EXPECT_EQ(odometry->reset(truth(kStart), 1e-6 * BodyCovariance::Identity()), Status::kOk);
    return odometry;
  }
  /// Samples after the newest one up to `until`.
  void feed(Odometry& odometry, Time until) {
    for (; next_ <= until; next_ += kSample) {
      EXPECT_EQ(odometry.add_imu(imu(next_)), Status::kOk);
    }
  }

  Options options_;
  Time next_ = kStart;
};

}  // namespace rio::test

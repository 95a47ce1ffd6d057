// SPDX-License-Identifier: BSD-3-Clause
// Samples of an IMU that stands, more or less, and the alignment from them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "rio/propagate/static_alignment.hpp"
#include "support/constants.hpp"
#include "support/random_state.hpp"

namespace rio::test {

inline constexpr double kRate = 200.0;  // [Hz]

/// An IMU at rest; `motion` may add to a sample what moves it, t seconds after the start.
struct StandingImu {
  Vector3d up_B = Vector3d::UnitZ();
  double gravity = kGravity;
  Vector3d gyro_bias = Vector3d::Zero();
  Vector3d accel_bias = Vector3d::Zero();
  double gyro_sigma = 0.0;
  double accel_sigma = 0.0;
  std::function<void(double t, ImuSample& sample)> motion{};

  static Time start() { return Time(100'000'000'000); }
  ImuSample sample(int i, Random& random) const {
    ImuSample s;
    s.time = start() + Time(5'000'000) * i;
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

/// Feeds samples from `first` on until aligned, `count` at most.
inline Outcome align(StaticAligner& aligner, const StandingImu& imu, Random& random, int first,
                     int count) {
  Outcome out;
  for (; out.samples < count && !out.alignment; ++out.samples) {
    const Status status = aligner.add(imu.sample(first + out.samples, random), &out.alignment);
    EXPECT_TRUE(status == Status::kOk || status == Status::kMoving);
    EXPECT_FALSE(status == Status::kMoving && out.alignment);
    out.refusals += status == Status::kMoving ? 1 : 0;
  }
  return out;
}

/// A start of its own, with 400 samples at most.
inline Outcome align(const StandingImu& imu, Random& random, const StartOptions& start = {},
                     const ImuOptions& options = {}) {
  StaticAligner aligner(start, options);
  return align(aligner, imu, random, 0, 400);
}

/// MEMS noise of one sample at the default densities.
inline StandingImu noisy(const Vector3d& up_B) {
  return {
      .up_B = up_B, .gyro_sigma = 4e-4 * std::sqrt(kRate), .accel_sigma = 4e-3 * std::sqrt(kRate)};
}

}  // namespace rio::test

// SPDX-License-Identifier: BSD-3-Clause
// What the tests of preintegration and of its factor share: random IMU steps, and how far two
// covariances are apart.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "rio/smoother/preintegration.hpp"
#include "support/random_state.hpp"

namespace rio::test {

using Steps = std::vector<ImuStep>;

// At rest but for rounding, as flown, and beyond any gyro's range [rad/s].
inline constexpr double kRates[] = {1e-9, 1.5, 30.0};

// Steps of 2 to 20 ms with independent readings: harder than any flight.
inline Steps random_steps(Random& random, int count, double rate) {
  Steps steps;
  Time time = from_seconds(12.5);
  for (int i = 0; i < count; ++i) {
    const Time end = time + from_seconds(random.uniform(0.002, 0.02));
    steps.push_back({time, end, random.normal_vector(rate), random.normal_vector(6.0), 0.0});
    time = end;
  }
  return steps;
}

inline double seconds(const ImuStep& step) {
  return to_seconds(step.end - step.begin);
}

inline Preintegration preintegrate(const Steps& steps, const Vector3d& gyro_bias,
                                   const Vector3d& accel_bias, const ImuOptions& options = {}) {
  Preintegration out;
  out.reset(gyro_bias, accel_bias);
  for (const ImuStep& step : steps) out.step(step, options);
  return out;
}

// From the increment of body i to the navigation error in W.
inline Matrix15d to_world(const Quaternion& q_WB) {
  Matrix15d M = Matrix15d::Identity();
  M.block<3, 3>(body::kPosition, body::kPosition) = q_WB.toRotationMatrix();
  M.block<3, 3>(body::kVelocity, body::kVelocity) = q_WB.toRotationMatrix();
  return M;
}

// Largest entry of A - B, each relative to the sigmas of B.
inline double relative_difference(const Matrix15d& A, const Matrix15d& B) {
  const BodyVector inverse_sigma = B.diagonal().cwiseSqrt().cwiseInverse();
  return (inverse_sigma.asDiagonal() * (A - B) * inverse_sigma.asDiagonal()).cwiseAbs().maxCoeff();
}

}  // namespace rio::test

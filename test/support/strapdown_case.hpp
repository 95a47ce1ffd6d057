// SPDX-License-Identifier: BSD-3-Clause
// States and IMU readings to try strapdown integration on, and how far two covariances are apart.
#pragma once

#include <vector>

#include "rio/propagate/strapdown.hpp"
#include "support/random_state.hpp"

namespace rio::test {

/// A state and the readings held over one step.
struct StrapdownCase {
  NavState state;
  Vector3d gyro = Vector3d::Zero();
  Vector3d accel = Vector3d::Zero();

  Matrix3d rotation() const { return state.q_WB.toRotationMatrix(); }
  Vector3d w() const { return gyro - state.gyro_bias; }
  Vector3d a() const { return accel - state.accel_bias; }
};

/// Lengths of the steps tried [s].
inline constexpr double kStrapdownSteps[] = {0.005, 0.066, 1.0};

/// At rest, hardly turning, and `turning` cases at some `rate` per axis [rad/s].
inline std::vector<StrapdownCase> strapdown_cases(int turning, double rate) {
  Random random(1);
  std::vector<StrapdownCase> out(2);
  out[0].accel = 9.81 * Vector3d::UnitZ();
  out[1] = {random.state(), Vector3d::Zero(), random.normal_vector(5.0)};
  out[1].gyro = out[1].state.gyro_bias + 1e-8 * random.direction();
  for (int i = 0; i < turning; ++i) {
    out.push_back({random.state(), random.normal_vector(rate), random.normal_vector(8.0)});
  }
  return out;
}

using Steps = std::vector<ImuStep>;

/// Steps of 2 to 20 ms with independent readings: harder than any flight.
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

/// Largest entry of A - B, each relative to the sigmas of B.
inline double relative_difference(const Matrix15d& A, const Matrix15d& B) {
  const BodyVector inverse_sigma = B.diagonal().cwiseSqrt().cwiseInverse();
  return (inverse_sigma.asDiagonal() * (A - B) * inverse_sigma.asDiagonal()).cwiseAbs().maxCoeff();
}

}  // namespace rio::test

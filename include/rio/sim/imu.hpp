// SPDX-License-Identifier: BSD-3-Clause
// Simulated IMU: the exact instantaneous motion plus bias, white noise, vibration and saturation.
//
// (E1) sample = truth + bias + vibration + density * sqrt(rate) * n, n ~ N(0, 1) per axis
// (E2) bias' = bias + random_walk / sqrt(rate) * n, from one sample to the next
#pragma once

#include <array>
#include <cstdint>

#include "rio/sim/random.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// The inertial sensor that is simulated. Defaults: a consumer MEMS unit on a quadrotor.
struct ImuModel {
  double rate_hz = 200.0;                ///< [Hz]
  double gyro_noise_density = 2e-4;      ///< white noise [rad/s/sqrt(Hz)]
  double gyro_random_walk = 2e-5;        ///< bias random walk [rad/s^2/sqrt(Hz)]
  double gyro_turn_on_sigma = 5e-3;      ///< first bias, per axis [rad/s]
  double gyro_vibration = 0.01;          ///< amplitude per axis while flying [rad/s]
  double gyro_limit = 34.9;              ///< saturation [rad/s]
  double accel_noise_density = 2e-3;     ///< white noise [m/s^2/sqrt(Hz)]
  double accel_random_walk = 2e-4;       ///< bias random walk [m/s^3/sqrt(Hz)]
  double accel_turn_on_sigma = 5e-2;     ///< first bias, per axis [m/s^2]
  double accel_vibration = 0.2;          ///< amplitude per axis while flying [m/s^2]
  double accel_limit = 156.9;            ///< saturation [m/s^2]
  double vibration_frequency_hz = 87.0;  ///< of the first rotor; the others are 3 % apart [Hz]
  double stamp_jitter = 0.0;             ///< standard deviation of the stamps [s]

  /// Only what a filter models: bias and white noise, no vibration.
  static ImuModel ideal();
  /// The exact motion.
  static ImuModel noise_free();
};

/// Turns the motion into samples, one call a sample, `rate_hz` calls a second.
class ImuSimulator {
 public:
  ImuSimulator(const ImuModel& model, std::uint64_t seed);

  /// The biases in the next sample.
  const Vector3d& gyro_bias() const { return gyro_bias_; }
  const Vector3d& accel_bias() const { return accel_bias_; }

  /// The sample at `point`; afterwards the biases walk one step.
  ImuSample sample(const Trajectory::Point& point);

 private:
  /// One sinusoid of unit amplitude an axis, rotors slightly apart in speed.
  Vector3d vibration(std::size_t first) const;

  ImuModel model_;
  Random random_;
  Vector3d gyro_bias_;
  Vector3d accel_bias_;
  std::array<double, 6> phases_{};
  std::uint64_t count_ = 0;
};

}  // namespace rio::sim

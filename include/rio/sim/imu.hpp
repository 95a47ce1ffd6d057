// SPDX-License-Identifier: BSD-3-Clause
// Simulated IMU: the exact instantaneous motion plus bias, white noise, vibration and saturation.
//
// (E1) sample = truth + bias + vibration + density * sqrt(rate) * n, n ~ N(0, 1) per axis
// (E2) bias' = bias + random_walk / sqrt(rate) * n, from one sample to the next
// (E3) a shaking frame, per axis: rms * Re z, z' = k z + sqrt(1 - k^2) n e^(i a), n complex of unit
//      variance per part, k = exp(-2 pi b / rate), z turned by a = 2 pi f / rate from sample to
//      sample: noise of spectrum b / ((f' - f)^2 + b^2), as it is sampled, aliases included
// (E4) rms^2 = rest^2 + (moving^2 - rest^2) min(1, speed / shaking_speed)^2 exp(2 (s g - s^2)),
//      g of unit variance, correlated over shaking_time: the ground varies, the mean square does
//      not
#pragma once

#include <array>
#include <complex>
#include <cstdint>

#include "rio/sim/random.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// Noise of a vehicle's frame around a resonance, (E3) and (E4). It shakes the IMU alone: its
/// displacement is below the resolution of the radar.
struct Shaking {
  double frequency_hz = 20.0;  ///< centre [Hz]; beyond half the rate it aliases
  double width_hz = 10.0;      ///< half width at half power [Hz]
  double gyro_rest = 0.0;      ///< rms per axis at rest, engine running [rad/s]
  double gyro_moving = 0.0;    ///< same at full speed [rad/s]
  double accel_rest = 0.0;     ///< [m/s^2]
  double accel_moving = 0.0;   ///< [m/s^2]
};

/// The simulated inertial sensor. Defaults: a consumer MEMS unit on a quadrotor.
struct ImuModel {
  double rate_hz = 200.0;                ///< [Hz]
  double gyro_noise_density = 2e-4;      ///< white noise [rad/s/sqrt(Hz)]
  double gyro_random_walk = 2e-5;        ///< bias random walk [rad/s^2/sqrt(Hz)]
  double gyro_turn_on_sigma = 5e-3;      ///< initial bias, per axis [rad/s]
  double gyro_vibration = 0.01;          ///< amplitude per axis while flying [rad/s]
  double gyro_limit = 34.9;              ///< saturation [rad/s]
  double accel_noise_density = 2e-3;     ///< white noise [m/s^2/sqrt(Hz)]
  double accel_random_walk = 2e-4;       ///< bias random walk [m/s^3/sqrt(Hz)]
  double accel_turn_on_sigma = 5e-2;     ///< initial bias, per axis [m/s^2]
  double accel_vibration = 0.2;          ///< amplitude per axis while flying [m/s^2]
  double accel_limit = 156.9;            ///< saturation [m/s^2]
  double vibration_frequency_hz = 87.0;  ///< of the first rotor; the others are 3 % apart [Hz]
  double stamp_jitter = 0.0;             ///< standard deviation of the stamps [s]
  Shaking low{};                ///< of the frame, in addition to the vibration of the rotors
  Shaking high{};               ///< another one
  double shaking_speed = 1.0;   ///< speed from which the shaking is that of motion [m/s]
  double shaking_spread = 0.0;  ///< s of (E4), of the logarithm of the rms in motion
  double shaking_time = 0.5;    ///< e-folding time of that [s]
  double lost_share = 0.0;      ///< share of lost samples
  double lost_run = 1.0;        ///< mean number of consecutive lost samples
  bool lost_filled = false;  ///< lost samples are interpolated between the neighbours; else missing

  /// Only what a filter models: bias and white noise, no vibration.
  static ImuModel ideal();
  /// The exact motion.
  static ImuModel noise_free();
};

/// Turns the motion into samples, one call per sample, `rate_hz` calls a second.
class ImuSimulator {
 public:
  ImuSimulator(const ImuModel& model, std::uint64_t seed);

  /// The biases in the next sample.
  const Vector3d& gyro_bias() const { return gyro_bias_; }
  const Vector3d& accel_bias() const { return accel_bias_; }

  /// The sample at `point`; then the biases walk one step.
  ImuSample sample(const Trajectory::Point& point);

 private:
  /// State of a Shaking: gyro and specific force.
  using Phasor = Eigen::Matrix<std::complex<double>, 6, 1>;

  /// Advances (E3) by one sample and adds it.
  /// @param level of the rms in motion, between rest and moving
  void shake(const Shaking& shaking, double level, Phasor* z, ImuSample* sample);
  /// The next level of (E4).
  double roughness(double speed);
  Phasor noise();

  /// One sinusoid of unit amplitude per axis, rotors at slightly different speeds.
  Vector3d vibration(std::size_t first) const;

  ImuModel model_;
  Random random_;
  Vector3d gyro_bias_;
  Vector3d accel_bias_;
  std::array<double, 6> phases_{};
  std::uint64_t count_ = 0;
  Random shaking_random_;
  Phasor low_;
  Phasor high_;
  double ground_ = 0.0;  ///< g of (E4)
};

/// Which samples are lost, one call per sample: runs of geometric length, `share` of all.
class Losses {
 public:
  Losses(const ImuModel& model, std::uint64_t seed);
  bool next();

 private:
  double begin_;  ///< probability that a run begins after a received sample
  double go_on_;  ///< probability that a run continues
  bool lost_ = false;
  Random random_;
};

}  // namespace rio::sim

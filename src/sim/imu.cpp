// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/imu.hpp"

#include <cmath>
#include <numbers>

namespace rio::sim {

ImuModel ImuModel::ideal() {
  ImuModel model;
  model.gyro_vibration = model.accel_vibration = 0.0;
  return model;
}

ImuModel ImuModel::noise_free() {
  ImuModel model = ideal();
  model.gyro_noise_density = model.gyro_random_walk = model.gyro_turn_on_sigma = 0.0;
  model.accel_noise_density = model.accel_random_walk = model.accel_turn_on_sigma = 0.0;
  return model;
}

ImuSimulator::ImuSimulator(const ImuModel& model, std::uint64_t seed)
    : model_(model), random_(seed, 2) {
  gyro_bias_ = model_.gyro_turn_on_sigma * random_.normal3();
  accel_bias_ = model_.accel_turn_on_sigma * random_.normal3();
  for (double& phase : phases_) phase = random_.uniform(0.0, 2.0 * std::numbers::pi);
}

ImuSample ImuSimulator::sample(const Trajectory::Point& point) {
  const double root_rate = std::sqrt(model_.rate_hz);
  ImuSample sample;
  sample.time = point.nav.time;
  sample.gyro_B = point.gyro_B + gyro_bias_ +
                  model_.gyro_noise_density * root_rate * random_.normal3();  // (E1)
  sample.accel_B =
      point.accel_B + accel_bias_ + model_.accel_noise_density * root_rate * random_.normal3();
  if (point.flying) {
    sample.gyro_B += model_.gyro_vibration * vibration(0);
    sample.accel_B += model_.accel_vibration * vibration(3);
  }
  sample.gyro_B = sample.gyro_B.cwiseMax(-model_.gyro_limit).cwiseMin(model_.gyro_limit);
  sample.accel_B = sample.accel_B.cwiseMax(-model_.accel_limit).cwiseMin(model_.accel_limit);

  gyro_bias_ += model_.gyro_random_walk / root_rate * random_.normal3();  // (E2)
  accel_bias_ += model_.accel_random_walk / root_rate * random_.normal3();
  ++count_;
  return sample;
}

Vector3d ImuSimulator::vibration(std::size_t first) const {
  Vector3d value;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double frequency =
        model_.vibration_frequency_hz * (1.0 + 0.03 * static_cast<double>(axis));
    const double cycles = frequency / model_.rate_hz * static_cast<double>(count_);
    value[static_cast<Eigen::Index>(axis)] =
        std::sin(2.0 * std::numbers::pi * cycles + phases_[first + axis]);
  }
  return value;
}

}  // namespace rio::sim

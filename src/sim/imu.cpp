// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/imu.hpp"

#include <algorithm>
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
    : model_(model), random_(seed, 2), shaking_random_(seed, 12) {
  gyro_bias_ = model_.gyro_turn_on_sigma * random_.normal3();
  accel_bias_ = model_.accel_turn_on_sigma * random_.normal3();
  for (double& phase : phases_) phase = random_.uniform(0.0, 2.0 * std::numbers::pi);
  low_ = noise();
  high_ = noise();
  ground_ = shaking_random_.normal();
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
  const double level = roughness(point.nav.v_WB.norm());
  shake(model_.low, level, &low_, &sample);
  shake(model_.high, level, &high_, &sample);
  sample.gyro_B = sample.gyro_B.cwiseMax(-model_.gyro_limit).cwiseMin(model_.gyro_limit);
  sample.accel_B = sample.accel_B.cwiseMax(-model_.accel_limit).cwiseMin(model_.accel_limit);

  gyro_bias_ += model_.gyro_random_walk / root_rate * random_.normal3();  // (E2)
  accel_bias_ += model_.accel_random_walk / root_rate * random_.normal3();
  ++count_;
  return sample;
}

double ImuSimulator::roughness(double speed) {
  const double keep = std::exp(-1.0 / (model_.rate_hz * model_.shaking_time));
  ground_ = keep * ground_ + std::sqrt(1.0 - keep * keep) * shaking_random_.normal();
  const double spread = model_.shaking_spread;
  const double full = std::min(1.0, speed / model_.shaking_speed);
  return full * std::exp(spread * ground_ - spread * spread);  // (E4)
}

void ImuSimulator::shake(const Shaking& shaking, double level, Phasor* z, ImuSample* sample) {
  const double keep = std::exp(-2.0 * std::numbers::pi * shaking.width_hz / model_.rate_hz);
  const double turn = 2.0 * std::numbers::pi * shaking.frequency_hz / model_.rate_hz;
  *z = std::polar(1.0, turn) * (keep * *z + std::sqrt(1.0 - keep * keep) * noise());  // (E3)
  const auto rms = [level](double rest, double moving) {                              // (E4)
    return std::sqrt(rest * rest + std::max(0.0, moving * moving - rest * rest) * level * level);
  };
  const double gyro = rms(shaking.gyro_rest, shaking.gyro_moving);
  const double accel = rms(shaking.accel_rest, shaking.accel_moving);
  if (gyro > 0.0) sample->gyro_B += gyro * z->head<3>().real();
  if (accel > 0.0) sample->accel_B += accel * z->tail<3>().real();
}

ImuSimulator::Phasor ImuSimulator::noise() {
  Phasor n;
  for (auto& part : n) part = {shaking_random_.normal(), shaking_random_.normal()};
  return n;
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

Losses::Losses(const ImuModel& model, std::uint64_t seed)
    : go_on_(1.0 - 1.0 / model.lost_run), random_(seed, 13) {
  // share = begin / (begin + 1 - go_on), the balance of the two states
  begin_ = model.lost_share * (1.0 - go_on_) / (1.0 - model.lost_share);
}

bool Losses::next() {
  return lost_ = random_.uniform() < (lost_ ? go_on_ : begin_);
}

}  // namespace rio::sim

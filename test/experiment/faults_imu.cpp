// SPDX-License-Identifier: BSD-3-Clause
// Faults of the IMU data.
#include <fmt/format.h>

#include <cmath>

#include "experiment/fault.hpp"

namespace rio::experiment {

namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

using ChangeSample = std::function<void(ImuSample&, Moment&)>;

Fault samples(const std::string& name, double duration, Promise promise, double within,
              const ChangeSample& change) {
  return {.name = name,
          .promise = promise,
          .within = within,
          .duration = duration,
          .change = [change](Event& e, Moment& m) {
            if (e.is_imu()) change(e.sample, m);
          }};
}

Fault one_sample(const std::string& name, Promise promise, double within,
                 const std::function<void(ImuSample&)>& change) {
  return samples(name, 1.0, promise, within, [change](ImuSample& s, Moment& m) {
    if (m.n == 0) change(s);
  });
}

void freeze(ImuSample& s, Moment& m) {
  s.gyro_B = m.before.sample.gyro_B;
  s.accel_B = m.before.sample.accel_B;
}

void full_scale(ImuSample& s, Moment&) {
  s.gyro_B.setConstant(34.9);
  s.accel_B.setConstant(156.9);
}

void add_spikes(std::vector<Fault>& all) {
  constexpr Promise kIgnored = Promise::kIgnored;
  constexpr Promise kRecovered = Promise::kRecovered;
  all.push_back(one_sample("one sample of 1e299 rad/s", kIgnored, 0.0,
                           [](ImuSample& s) { s.gyro_B.setConstant(1e299); }));
  all.push_back(one_sample("one sample of 1e4 m/s^2", kIgnored, 0.0,
                           [](ImuSample& s) { s.accel_B.z() = 1e4; }));
  all.push_back(one_sample("one sample of 100 m/s^2", kRecovered, 5.0,
                           [](ImuSample& s) { s.accel_B.x() = 100.0; }));
  all.push_back(one_sample("one sample of 30 rad/s", kRecovered, 10.0,
                           [](ImuSample& s) { s.gyro_B.x() = 30.0; }));
  all.push_back(samples("1 % of spikes of 50 m/s^2, 10 rad/s for 10 s", 10.0, kRecovered, 10.0,
                        [](ImuSample& s, Moment& m) {
                          if (m.random.uniform() > 0.01) return;
                          s.accel_B += 50.0 * m.random.normal3().normalized();
                          s.gyro_B += 10.0 * m.random.normal3().normalized();
                        }));
}

void add_dead_axes(std::vector<Fault>& all) {
  constexpr Promise kRecovered = Promise::kRecovered;
  all.push_back(samples("all values 0 for 2 s", 2.0, kRecovered, 10.0, [](ImuSample& s, Moment&) {
    s.gyro_B.setZero();
    s.accel_B.setZero();
  }));
  all.push_back(samples("gyro x reads 0 for 5 s", 5.0, kRecovered, 10.0,
                        [](ImuSample& s, Moment&) { s.gyro_B.x() = 0.0; }));
  all.push_back(samples("gyro z reads 0 for 5 s", 5.0, Promise::kHonest, 0.0,
                        [](ImuSample& s, Moment&) { s.gyro_B.z() = 0.0; }));
  all.push_back(
      samples("accel z stuck for 5 s", 5.0, kRecovered, 10.0,
              [](ImuSample& s, Moment& m) { s.accel_B.z() = m.before.sample.accel_B.z(); }));
  all.push_back(samples("accel frozen for 5 s", 5.0, kRecovered, 10.0,
                        [](ImuSample& s, Moment& m) { s.accel_B = m.before.sample.accel_B; }));
  all.push_back(samples("gyro frozen for 5 s", 5.0, kRecovered, 10.0,
                        [](ImuSample& s, Moment& m) { s.gyro_B = m.before.sample.gyro_B; }));
  all.push_back(samples("accel reads 0 for 5 s", 5.0, kRecovered, 10.0,
                        [](ImuSample& s, Moment&) { s.accel_B.setZero(); }));
  all.push_back(samples("vibration of 3 g and 1 rad/s for 10 s", 10.0, kRecovered, 10.0,
                        [](ImuSample& s, Moment& m) {
                          s.accel_B += 30.0 * m.random.normal3();
                          s.gyro_B += 1.0 * m.random.normal3();
                        }));
}

void add_bias_steps(std::vector<Fault>& all) {
  for (int axis = 0; axis < 3; ++axis) {
    // only landmarks distinguish a rotation about the vertical from a bias
    all.push_back(samples(fmt::format("gyro bias {} +0.01 rad/s", kAxes[axis]), kForGood,
                          axis == 2 ? Promise::kHonest : Promise::kRecovered, 15.0,
                          [axis](ImuSample& s, Moment&) { s.gyro_B[axis] += 0.01; }));
  }
  for (int axis = 0; axis < 3; ++axis) {
    all.push_back(samples(fmt::format("accel bias {} +0.5 m/s^2", kAxes[axis]), kForGood,
                          Promise::kRecovered, 15.0,
                          [axis](ImuSample& s, Moment&) { s.accel_B[axis] += 0.5; }));
  }
  all.push_back(samples("gyro bias x +0.05 rad/s", kForGood, Promise::kRecovered, 15.0,
                        [](ImuSample& s, Moment&) { s.gyro_B.x() += 0.05; }));
  all.push_back(samples("gyro bias x creeps by 1e-3 rad/s^2", 20.0, Promise::kRecovered, 15.0,
                        [](ImuSample& s, Moment& m) { s.gyro_B.x() += 1e-3 * m.t; }));
}

}  // namespace

std::vector<Fault> imu_faults() {
  std::vector<Fault> all = {
      samples("gyro NaN for 0.2 s", 0.2, Promise::kRecovered, 2.0,
              [](ImuSample& s, Moment&) { s.gyro_B.x() = NAN; }),
      samples("accel NaN for 0.2 s", 0.2, Promise::kRecovered, 2.0,
              [](ImuSample& s, Moment&) { s.accel_B.z() = NAN; }),
      samples("gyro infinite for 0.2 s", 0.2, Promise::kRecovered, 2.0,
              [](ImuSample& s, Moment&) { s.gyro_B.y() = INFINITY; }),
      samples("accel infinite for 0.2 s", 0.2, Promise::kRecovered, 2.0,
              [](ImuSample& s, Moment&) { s.accel_B.x() = -INFINITY; }),
      samples("IMU of NaN for 2 s", 2.0, Promise::kRecovered, 10.0,
              [](ImuSample& s, Moment&) { s.gyro_B.setConstant(NAN); }),
      samples("IMU frozen for 0.1 s", 0.1, Promise::kRecovered, 2.0, freeze),
      samples("IMU frozen for 0.5 s", 0.5, Promise::kRecovered, 5.0, freeze),
      samples("IMU frozen for 2 s", 2.0, Promise::kRecovered, 10.0, freeze),
      samples("IMU at full scale for 0.02 s", 0.02, Promise::kBridged, 0.0, full_scale),
      samples("IMU at full scale for 0.5 s", 0.5, Promise::kRecovered, 5.0, full_scale),
  };
  add_spikes(all);
  add_dead_axes(all);
  add_bias_steps(all);
  for (const double hz : {10.0, 25.0, 50.0, 100.0, 500.0, 2000.0, 8000.0}) {
    all.push_back({.name = fmt::format("IMU at {} Hz", hz),
                   .promise = hz < 50.0 ? Promise::kHonest : Promise::kBridged,
                   .duration = kForGood,
                   .sensors = [hz](sim::Scenario& s) { s.imu.rate_hz = hz; }});
  }
  return all;
}

}  // namespace rio::experiment

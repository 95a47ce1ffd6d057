// SPDX-License-Identifier: BSD-3-Clause
// Faults of the IMU data.
#include <fmt/format.h>

#include <cmath>

#include "experiment/fault.hpp"

namespace rio::experiment {

namespace {

using ChangeSample = std::function<void(ImuSample&, Moment&)>;

Fault samples(const char* name, double duration, Promised promised, const ChangeSample& change) {
  return {name, Of::kImu, duration, promised,
          [change](Event& e, Moment& m) { change(e.sample, m); }};
}

/// The first sample alone.
Fault one_sample(const char* name, Promised promised,
                 const std::function<void(ImuSample&)>& change) {
  return samples(name, 1.0, promised, [change](ImuSample& s, Moment& m) {
    if (m.n == 0) change(s);
  });
}

void freeze_gyro(ImuSample& s, Moment& m) {
  s.gyro_B = m.before.sample.gyro_B;
}
void freeze_accel(ImuSample& s, Moment& m) {
  s.accel_B = m.before.sample.accel_B;
}
void freeze(ImuSample& s, Moment& m) {
  freeze_gyro(s, m);
  freeze_accel(s, m);
}
ChangeSample reading(double gyro, double accel) {
  return [gyro, accel](ImuSample& s, Moment&) {
    s.gyro_B.setConstant(gyro);
    s.accel_B.setConstant(accel);
  };
}
void spike(ImuSample& s, Moment& m) {
  if (m.random.uniform() > 0.01) return;
  s.accel_B += 50.0 * m.random.normal3().normalized();
  s.gyro_B += 10.0 * m.random.normal3().normalized();
}
void vibrate(ImuSample& s, Moment& m) {
  s.accel_B += 30.0 * m.random.normal3();
  s.gyro_B += 1.0 * m.random.normal3();
}
ChangeSample gyro_bias(int axis, double step) {
  return [axis, step](ImuSample& s, Moment&) { s.gyro_B[axis] += step; };
}
ChangeSample accel_bias(int axis, double step = 0.5) {
  return [axis, step](ImuSample& s, Moment&) { s.accel_B[axis] += step; };
}

}  // namespace

std::vector<Fault> imu_faults() {
  constexpr Promise kHonest = Promise::kHonest;
  constexpr Promise kBridged = Promise::kBridged;
  constexpr Promise kIgnored = Promise::kIgnored;
  const Promised brief = recovered(2.0);
  const Promised soon = recovered(5.0);
  const Promised later = recovered(10.0);
  const Promised learned = recovered(15.0);
  const ChangeSample full_scale = reading(34.9, 156.9);
  std::vector<Fault> all = {
      samples("gyro NaN for 0.2 s", 0.2, brief, [](auto& s, auto&) { s.gyro_B.x() = NAN; }),
      samples("accel NaN for 0.2 s", 0.2, brief, [](auto& s, auto&) { s.accel_B.z() = NAN; }),
      samples("gyro infinite for 0.2 s", 0.2, brief,
              [](auto& s, auto&) { s.gyro_B.y() = INFINITY; }),
      samples("accel infinite for 0.2 s", 0.2, brief,
              [](auto& s, auto&) { s.accel_B.x() = -INFINITY; }),
      samples("IMU of NaN for 2 s", 2.0, later, [](auto& s, auto&) { s.gyro_B.setConstant(NAN); }),
      samples("IMU frozen for 0.1 s", 0.1, brief, freeze),
      samples("IMU frozen for 0.5 s", 0.5, soon, freeze),
      samples("IMU frozen for 2 s", 2.0, later, freeze),
      samples("IMU at full scale for 0.02 s", 0.02, kBridged, full_scale),
      samples("IMU at full scale for 0.5 s", 0.5, soon, full_scale),
      one_sample("one sample of 1e299 rad/s", kIgnored,
                 [](ImuSample& s) { s.gyro_B.setConstant(1e299); }),
      one_sample("one sample of 1e4 m/s^2", kIgnored, [](ImuSample& s) { s.accel_B.z() = 1e4; }),
      one_sample("one sample of 100 m/s^2", soon, [](ImuSample& s) { s.accel_B.x() = 100.0; }),
      one_sample("one sample of 30 rad/s", later, [](ImuSample& s) { s.gyro_B.x() = 30.0; }),
      samples("1 % of spikes of 50 m/s^2, 10 rad/s for 10 s", 10.0, later, spike),
      samples("all values 0 for 2 s", 2.0, later, reading(0.0, 0.0)),
      samples("gyro x reads 0 for 5 s", 5.0, later, [](auto& s, auto&) { s.gyro_B.x() = 0.0; }),
      samples("gyro z reads 0 for 5 s", 5.0, kHonest, [](auto& s, auto&) { s.gyro_B.z() = 0.0; }),
      samples("accel z stuck for 5 s", 5.0, later,
              [](auto& s, auto& m) { s.accel_B.z() = m.before.sample.accel_B.z(); }),
      samples("accel frozen for 5 s", 5.0, later, freeze_accel),
      samples("gyro frozen for 5 s", 5.0, later, freeze_gyro),
      samples("accel reads 0 for 5 s", 5.0, later, [](auto& s, auto&) { s.accel_B.setZero(); }),
      samples("accel negated for 5 s", 5.0, later, [](auto& s, auto&) { s.accel_B *= -1.0; }),
      samples("accel y negated for 10 s", 10.0, later,
              [](auto& s, auto&) { s.accel_B.y() *= -1.0; }),
      samples("gyro negated for 10 s", 10.0, later, [](auto& s, auto&) { s.gyro_B *= -1.0; }),
      samples("vibration of 3 g and 1 rad/s for 10 s", 10.0, later, vibrate),
      samples("gyro bias x +0.01 rad/s", kForGood, learned, gyro_bias(0, 0.01)),
      samples("gyro bias y +0.01 rad/s", kForGood, learned, gyro_bias(1, 0.01)),
      // only landmarks distinguish a rotation about the vertical from a bias
      samples("gyro bias z +0.01 rad/s", kForGood, kHonest, gyro_bias(2, 0.01)),
      samples("accel bias x +0.5 m/s^2", kForGood, learned, accel_bias(0)),
      samples("accel bias y +0.5 m/s^2", kForGood, learned, accel_bias(1)),
      samples("accel bias z +0.5 m/s^2", kForGood, learned, accel_bias(2)),
      // small enough for no gate to notice: motors heat and shake the sensor
      samples("accel bias z +0.05 m/s^2", kForGood, learned, accel_bias(2, 0.05)),
      samples("accel bias z +0.2 m/s^2", kForGood, learned, accel_bias(2, 0.2)),
      samples("accel bias x +0.2 m/s^2", kForGood, learned, accel_bias(0, 0.2)),
      samples("gyro bias x +0.05 rad/s", kForGood, learned, gyro_bias(0, 0.05)),
      samples("gyro bias x creeps by 1e-3 rad/s^2", 20.0, learned,
              [](auto& s, auto& m) { s.gyro_B.x() += 1e-3 * m.t; }),
  };
  for (const double hz : {10.0, 25.0, 50.0, 100.0, 500.0, 2000.0, 8000.0}) {
    all.push_back({.name = fmt::format("IMU at {} Hz", hz),
                   .duration = kForGood,
                   .promised = hz < 50.0 ? kHonest : kBridged,
                   .sensors = [hz](sim::Scenario& s) { s.imu.rate_hz = hz; }});
  }
  return all;
}

}  // namespace rio::experiment

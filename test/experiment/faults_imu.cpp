// SPDX-License-Identifier: BSD-3-Clause
// Faults of the IMU data.
#include <fmt/format.h>

#include <cmath>

#include "experiment/fault.hpp"

namespace rio::experiment {

namespace {

using ChangeSample = std::function<void(ImuSample&, Moment&)>;

/// Of the first sample alone.
ChangeSample once(const std::function<void(ImuSample&)>& change) {
  return [change](ImuSample& s, Moment& m) {
    if (m.n == 0) change(s);
  };
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
void set_all(ImuSample& s, double gyro, double accel) {
  s.gyro_B.setConstant(gyro);
  s.accel_B.setConstant(accel);
}
void full_scale(ImuSample& s, Moment&) {
  set_all(s, 34.9, 156.9);
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
ChangeSample accel_bias(int axis) {
  return [axis](ImuSample& s, Moment&) { s.accel_B[axis] += 0.5; };
}

struct Row {
  const char* name;
  double duration;
  Promised promised;
  ChangeSample change;
};

std::vector<Row> rows() {
  constexpr Promise kHonest = Promise::kHonest;
  return {
      {"gyro NaN for 0.2 s", 0.2, recovered(2.0), [](auto& s, auto&) { s.gyro_B.x() = NAN; }},
      {"accel NaN for 0.2 s", 0.2, recovered(2.0), [](auto& s, auto&) { s.accel_B.z() = NAN; }},
      {"gyro infinite for 0.2 s", 0.2, recovered(2.0),
       [](auto& s, auto&) { s.gyro_B.y() = INFINITY; }},
      {"accel infinite for 0.2 s", 0.2, recovered(2.0),
       [](auto& s, auto&) { s.accel_B.x() = -INFINITY; }},
      {"IMU of NaN for 2 s", 2.0, recovered(10.0),
       [](auto& s, auto&) { s.gyro_B.setConstant(NAN); }},
      {"IMU frozen for 0.1 s", 0.1, recovered(2.0), freeze},
      {"IMU frozen for 0.5 s", 0.5, recovered(5.0), freeze},
      {"IMU frozen for 2 s", 2.0, recovered(10.0), freeze},
      {"IMU at full scale for 0.02 s", 0.02, Promise::kBridged, full_scale},
      {"IMU at full scale for 0.5 s", 0.5, recovered(5.0), full_scale},
      {"one sample of 1e299 rad/s", 1.0, Promise::kIgnored,
       once([](ImuSample& s) { s.gyro_B.setConstant(1e299); })},
      {"one sample of 1e4 m/s^2", 1.0, Promise::kIgnored,
       once([](ImuSample& s) { s.accel_B.z() = 1e4; })},
      {"one sample of 100 m/s^2", 1.0, recovered(5.0),
       once([](ImuSample& s) { s.accel_B.x() = 100.0; })},
      {"one sample of 30 rad/s", 1.0, recovered(10.0),
       once([](ImuSample& s) { s.gyro_B.x() = 30.0; })},
      {"1 % of spikes of 50 m/s^2, 10 rad/s for 10 s", 10.0, recovered(10.0), spike},
      {"all values 0 for 2 s", 2.0, recovered(10.0), [](auto& s, auto&) { set_all(s, 0.0, 0.0); }},
      {"gyro x reads 0 for 5 s", 5.0, recovered(10.0), [](auto& s, auto&) { s.gyro_B.x() = 0.0; }},
      {"gyro z reads 0 for 5 s", 5.0, kHonest, [](auto& s, auto&) { s.gyro_B.z() = 0.0; }},
      {"accel z stuck for 5 s", 5.0, recovered(10.0),
       [](auto& s, auto& m) { s.accel_B.z() = m.before.sample.accel_B.z(); }},
      {"accel frozen for 5 s", 5.0, recovered(10.0), freeze_accel},
      {"gyro frozen for 5 s", 5.0, recovered(10.0), freeze_gyro},
      {"accel reads 0 for 5 s", 5.0, recovered(10.0), [](auto& s, auto&) { s.accel_B.setZero(); }},
      {"vibration of 3 g and 1 rad/s for 10 s", 10.0, recovered(10.0), vibrate},
      {"gyro bias x +0.01 rad/s", kForGood, recovered(15.0), gyro_bias(0, 0.01)},
      {"gyro bias y +0.01 rad/s", kForGood, recovered(15.0), gyro_bias(1, 0.01)},
      // only landmarks distinguish a rotation about the vertical from a bias
      {"gyro bias z +0.01 rad/s", kForGood, kHonest, gyro_bias(2, 0.01)},
      {"accel bias x +0.5 m/s^2", kForGood, recovered(15.0), accel_bias(0)},
      {"accel bias y +0.5 m/s^2", kForGood, recovered(15.0), accel_bias(1)},
      {"accel bias z +0.5 m/s^2", kForGood, recovered(15.0), accel_bias(2)},
      {"gyro bias x +0.05 rad/s", kForGood, recovered(15.0), gyro_bias(0, 0.05)},
      {"gyro bias x creeps by 1e-3 rad/s^2", 20.0, recovered(15.0),
       [](auto& s, auto& m) { s.gyro_B.x() += 1e-3 * m.t; }},
  };
}

}  // namespace

std::vector<Fault> imu_faults() {
  std::vector<Fault> all;
  for (const Row& row : rows()) {
    all.push_back(changing(Of::kImu, row.name, row.duration, row.promised,
                           [change = row.change](Event& e, Moment& m) { change(e.sample, m); }));
  }
  for (const double hz : {10.0, 25.0, 50.0, 100.0, 500.0, 2000.0, 8000.0}) {
    all.push_back({.name = fmt::format("IMU at {} Hz", hz),
                   .promised = hz < 50.0 ? Promise::kHonest : Promise::kBridged,
                   .duration = kForGood,
                   .sensors = [hz](sim::Scenario& s) { s.imu.rate_hz = hz; }});
  }
  return all;
}

}  // namespace rio::experiment

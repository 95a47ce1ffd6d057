// SPDX-License-Identifier: BSD-3-Clause
// What the tests of simulated flights share: extremes of a path, all numbers of a flight, and dead
// reckoning, on purpose not the library's own strapdown.
//
// (E1) q' = q (0, w)/2, v' = R f - g e3, p' = v, by the classical Runge-Kutta method of order four.
//      One step takes two periods of the IMU, so that its three stages fall on samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "rio/sim/flight.hpp"
#include "rio/sim/imu.hpp"
#include "rio/sim/trajectory.hpp"

namespace rio::sim {

struct Extent {
  Vector3d low = Vector3d::Constant(1e9);    ///< [m]
  Vector3d high = Vector3d::Constant(-1e9);  ///< [m]
  double fastest = 0.0;                      ///< [m/s]
  double turn_rate = 0.0;                    ///< largest about z [rad/s]
};
/// Between two instants [s].
inline Extent extent(const Trajectory& trajectory, double begin, double end) {
  Extent extent;
  for (double t = begin; t < end; t += 0.01) {
    const Trajectory::Point point = trajectory.at(t);
    extent.low = extent.low.cwiseMin(point.nav.p_WB);
    extent.high = extent.high.cwiseMax(point.nav.p_WB);
    extent.fastest = std::max(extent.fastest, point.nav.v_WB.norm());
    extent.turn_rate = std::max(extent.turn_rate, std::abs(point.gyro_B.z()));
  }
  return extent;
}
/// Of all of it.
inline Extent extent(const Trajectory& trajectory) {
  return extent(trajectory, 0.0, trajectory.duration());
}

/// Each stamp is later than the one before.
template <class Stamped>
bool increasing(const std::vector<Stamped>& items) {
  const auto late = [](const Stamped& a, const Stamped& b) { return a.time >= b.time; };
  return std::adjacent_find(items.begin(), items.end(), late) == items.end();
}

/// Every number that a user of the flight sees, and the stamps in seconds after its start.
inline std::vector<double> numbers_of(const Flight& flight) {
  std::vector<double> all;
  const auto add = [&](const Vector3d& v) { all.insert(all.end(), {v.x(), v.y(), v.z()}); };
  const auto seconds = [&](Time time) { return to_seconds(time - flight.trajectory.start()); };
  for (const ImuSample& sample : flight.imu) {
    all.push_back(seconds(sample.time));
    add(sample.gyro_B);
    add(sample.accel_B);
  }
  for (const NavState& truth : flight.truth) {
    all.push_back(seconds(truth.time));
    add(truth.p_WB);
    add(truth.v_WB);
    add(truth.q_WB.vec());
    add(truth.gyro_bias);
    add(truth.accel_bias);
  }
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    all.push_back(seconds(flight.scans[i].time));
    all.push_back(seconds(flight.arrivals[i]));
    for (std::size_t k = 0; k < flight.scans[i].detections.size(); ++k) {
      const RadarDetection& detection = flight.scans[i].detections[k];
      add(detection.point_S);
      add({detection.range_rate, detection.snr_db, detection.noise_db});
      all.push_back(flight.labels[i][k].reflector);
      all.push_back(static_cast<double>(flight.labels[i][k].cause));
    }
  }
  add(flight.configured_T_BS.translation);
  add(flight.configured_T_BS.rotation.vec());
  return all;
}

/// Also where a comparison of the numbers does not tell: signs of zeros.
inline bool same_bytes(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// How far dead reckoning with samples free of noise ends from the truth.
struct Drift {
  double position = 0.0;  ///< [m]
  double attitude = 0.0;  ///< [rad]
  double moved = 0.0;     ///< sum of the steps, so that a test can see that it flew [m]
};

/// Dead reckoning of `trajectory` from `begin` on for `seconds`, at `rate_hz`. (E1)
inline Drift integrate_imu(const Trajectory& trajectory, double begin, double seconds,
                           double rate_hz) {
  using Vector10d = Eigen::Matrix<double, 10, 1>;  // q xyzw, p, v
  const double step = 2.0 / rate_hz;
  const Vector3d gravity(0.0, 0.0, -trajectory.gravity());
  const auto derivative = [&](const Vector10d& x, const ImuSample& sample) {
    const Quaternion q(x[3], x[0], x[1], x[2]);
    const Vector3d half = 0.5 * sample.gyro_B;
    Vector10d rate;
    rate << (q * Quaternion(0.0, half.x(), half.y(), half.z())).coeffs(), x.tail<3>(),
        q.normalized() * sample.accel_B + gravity;
    return rate;
  };
  ImuModel model = ImuModel::noise_free();
  model.rate_hz = rate_hz;
  ImuSimulator imu(model, 1);
  const auto sample_at = [&](int i) { return imu.sample(trajectory.at(begin + i / rate_hz)); };

  const NavState first = trajectory.at(begin).nav;
  Vector10d x;
  x << first.q_WB.coeffs(), first.p_WB, first.v_WB;
  Drift drift;
  ImuSample now = sample_at(0);
  const int steps = static_cast<int>(std::lround(seconds / step));
  for (int i = 0; i < steps; ++i) {
    const ImuSample middle = sample_at(2 * i + 1);
    const ImuSample next = sample_at(2 * i + 2);
    const Vector10d k1 = derivative(x, now);
    const Vector10d k2 = derivative(x + 0.5 * step * k1, middle);
    const Vector10d k3 = derivative(x + 0.5 * step * k2, middle);
    const Vector10d k4 = derivative(x + step * k3, next);
    const Vector10d change = step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    drift.moved += change.segment<3>(4).norm();
    x += change;
    x.head<4>().normalize();
    now = next;
  }
  const NavState last = trajectory.at(begin + steps * step).nav;
  drift.position = (x.segment<3>(4) - last.p_WB).norm();
  drift.attitude = Quaternion(x[3], x[0], x[1], x[2]).angularDistance(last.q_WB);
  return drift;
}

}  // namespace rio::sim

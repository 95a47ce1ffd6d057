// SPDX-License-Identifier: BSD-3-Clause
// Dead reckoning for tests of the simulator, on purpose not the library's own strapdown.
//
// (E1) q' = q (0, w)/2, v' = R f - g e3, p' = v, by the classical Runge-Kutta method of order four.
//      One step takes two periods of the IMU, so that its three stages fall on samples.
#pragma once

#include <cmath>

#include "rio/sim/imu.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::test {

/// How far dead reckoning with samples free of noise ends from the truth.
struct Drift {
  double position = 0.0;  ///< [m]
  double attitude = 0.0;  ///< [rad]
  double moved = 0.0;     ///< sum of the steps, so that a test can see that it flew [m]
};

/// Dead reckoning of `trajectory` from `begin` on for `seconds`, at `rate_hz`. (E1)
inline Drift integrate_imu(const sim::Trajectory& trajectory, double begin, double seconds,
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
  sim::ImuModel model = sim::ImuModel::noise_free();
  model.rate_hz = rate_hz;
  sim::ImuSimulator imu(model, 1);
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

}  // namespace rio::test

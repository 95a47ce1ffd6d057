// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: the motion of the body as far as the noise of its sensors does not explain it: the point
// at which the Jacobians of the calibration are evaluated.
//
// The predicted velocity v^ contains the noise of the accelerometer, of density q: at v^ a scan
// after dt claims from noise alone the information
// (E1) E|n x dv|^2 / (q dt) = 4 about a rotation of the mounting about the axis n,
// and the same noise in its residual draws the estimate (data/theory.md, 6). A linearisation point
// without this noise has neither fault: it follows the acceleration that white noise cannot
// explain, and otherwise v^ slowly:
// (E2) a = c + (1 - n / |d|^2)+ d, d = a^ - c, c = w x v: of a velocity that turns with the body,
//      as that of a vehicle; a^ the change of v^ per time after two low-passes of time constant m,
//      n = 25 x 3 q / (4 m) five sigmas of what white noise leaves (James-Stein shrinkage)
// (E3) v <- v + a dt + (v^ - v) dt / (T + dt), v^ as corrected by the scan before; v <- v^ while
//      the velocity is not known (sigma above 0.5 m/s) and when it has become so
// (E4) w <- w + (1 - n / |d|^2)+ d, d = w^ - w, n = 16 x 3 sigma_w^2: four sigmas of a sample; then
//      as (E3)
// Frames: v in B, a in W. With a good IMU, v is v^ after the delay of (E2); with an accelerometer
// that vibrates, the mean of T in body axes.
// Reference: Fuller, Measurement Error Models, 1987, 1.4 (instrumental variables).
#pragma once

#include "rio/types.hpp"

namespace rio {

/// Linearisation point of the calibration.
struct SteadyMotion {
  Vector3d v_B = Vector3d::Zero();      ///< velocity [m/s]
  Vector3d rate_B = Vector3d::Zero();   ///< angular rate, without bias [rad/s]
  Vector3d accel_W = Vector3d::Zero();  ///< acceleration, without vibration (E2) [m/s^2]
};

class SteadyMotionFilter {
 public:
  /// Starts over at the velocity v_B [m/s].
  void reset(const Vector3d& v_B) {
    *this = SteadyMotionFilter{};
    motion_.v_B = v_B;
  }

  /// (E2): the velocity changes by `change_W` [m/s] in `seconds`.
  void add(const Vector3d& change_W, double seconds);

  /// (E2) to (E4): the body was propagated for `seconds` from `before` to `after`.
  /// @param rate_B angular rate at `after` [rad/s]
  /// @param accel_density of the accelerometer [(m/s^2)^2/Hz]
  /// @param rate_variance of a gyro sample [rad^2/s^2]
  /// @param velocity_variance of `before` in body axes, all axes [m^2/s^2]
  void advance(const NavState& before, const NavState& after, const Vector3d& rate_B,
               double seconds, double accel_density, double rate_variance,
               double velocity_variance);

  const SteadyMotion& motion() const { return motion_; }

 private:
  SteadyMotion motion_;
  bool unknown_ = false;                 ///< the velocity, at the call before
  Vector3d once_W_ = Vector3d::Zero();   ///< acceleration, smoothed once [m/s^2]
  Vector3d twice_W_ = Vector3d::Zero();  ///< same, twice [m/s^2]
};

}  // namespace rio

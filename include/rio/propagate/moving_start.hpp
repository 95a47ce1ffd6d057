// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: the first state without a standstill, from the mean specific force of some seconds. Its
// covariance allows for the motion of a small robot; the first scans then determine the velocity.
//
// (E1) F <- Exp(w dt)^T F,  F <- F + (f - F) min(1, dt / T), T = min(elapsed, duration): the mean
//      of the specific force in the axes of the body as it is now, w the measured rate
// (E2) R F/|F| = e_z, yaw 0: exact but for the mean acceleration, the change of velocity over T
#pragma once

#include <optional>

#include "rio/core/so3.hpp"
#include "rio/options.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/types.hpp"

namespace rio {

class MovingStart {
 public:
  /// @param gravity [m/s^2]
  MovingStart(const StartOptions& start, double gravity) : start_(start), gravity_(gravity) {}

  /// Starts over, as after a pause of the IMU, in which the body may have turned.
  void reset() { begin_.reset(); }

  /// The first state, once `StartOptions::max_wait` has passed; never if that is 0.
  std::optional<Alignment> add(const ImuSample& sample);

  /// Norm of the mean specific force [m/s^2].
  double force() const { return up_B_.norm(); }

 private:
  static constexpr double kVelocity = 5.0;  // of a small robot: sigma per axis [m/s]

  StartOptions start_;
  double gravity_;
  std::optional<Time> begin_;
  Time newest_{0};
  Vector3d up_B_ = Vector3d::Zero();
};

}  // namespace rio

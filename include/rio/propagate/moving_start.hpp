// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: the first state without a standstill, from the mean specific force of some seconds. Its
// covariance admits what a flight may do; the first scans then tell the velocity.
//
// (E1) F <- Exp(w dt)^T F,  F <- F + (f - F) dt / min(elapsed, duration): the mean of the specific
//      force in the axes of the body as it is now, w the measured rate
// (E2) R F/|F| = e_z, yaw 0: exact but for the mean acceleration, which is the change of velocity
//      over the duration
#pragma once

#include <algorithm>
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

  void reset() { begin_.reset(); }

  /// A state once `StartOptions::max_wait` is over, if there is such a time.
  std::optional<Alignment> add(const ImuSample& sample) {
    if (!begin_) {
      begin_ = newest_ = sample.time;
      up_B_ = sample.accel_B;
    }
    const double dt = to_seconds(sample.time - newest_);
    const double elapsed = to_seconds(sample.time - *begin_);
    newest_ = sample.time;
    up_B_ = quaternion_exp(-dt * sample.gyro_B) * up_B_;  // (E1)
    if (dt > 0.0) up_B_ += (sample.accel_B - up_B_) * dt / std::min(elapsed, start_.duration);
    if (start_.max_wait <= 0.0 || elapsed < start_.max_wait || !(up_B_.norm() > 0.0)) return {};
    return at(sample.time);
  }

 private:
  Alignment at(Time time) const {
    Alignment out;
    out.state.time = time;
    const Vector3d y = up_B_.normalized();
    out.state.q_WB = level(y);  // (E2)
    const Matrix3d along = y * y.transpose();
    const double tilt = kVelocityChange / (start_.duration * gravity_);
    BodyCovariance& P = out.covariance;
    P.block<3, 3>(body::kAttitude, body::kAttitude) =
        tilt * tilt * (Matrix3d::Identity() - along) + start_.sigma_yaw * start_.sigma_yaw * along;
    const auto set = [&P](int block, double sigma) {
      P.block<3, 3>(block, block) = sigma * sigma * Matrix3d::Identity();
    };
    set(body::kPosition, start_.sigma_position);
    set(body::kVelocity, kVelocity);
    set(body::kGyroBias, start_.sigma_gyro_bias);
    set(body::kAccelBias, start_.sigma_accel_bias);
    return out;
  }

  static constexpr double kVelocity = 5.0;        // of a small robot, per axis, one sigma [m/s]
  static constexpr double kVelocityChange = 2.0;  // of it over the duration, same [m/s]

  StartOptions start_;
  double gravity_;
  std::optional<Time> begin_;
  Time newest_{0};
  Vector3d up_B_ = Vector3d::Zero();
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Stage 8: propagates the corrected mean through the buffered IMU samples to the newest one.
#pragma once

#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/types.hpp"

namespace rio {

class Predictor {
 public:
  explicit Predictor(double gravity) : gravity_(gravity) {}

  const NavState& state() const { return state_; }

  /// After an update or a reset: starts over from the corrected state.
  void rebase(const NavState& corrected, const ImuBuffer& imu) {
    state_ = corrected;
    advance(imu);
  }
  /// To the newest sample; constant time when called for every sample.
  void advance(const ImuBuffer& imu) {
    if (imu.empty()) return;
    imu.for_each_step(state_.time, imu.newest().time,
                      [this](const ImuStep& step) { integrate(step, gravity_, state_); });
  }

 private:
  double gravity_;
  NavState state_;
};

}  // namespace rio

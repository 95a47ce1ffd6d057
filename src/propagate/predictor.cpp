// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/predictor.hpp"

namespace rio {

void Predictor::rebase(const NavState& corrected, const ImuBuffer& imu) {
  state_ = corrected;
  advance(imu);
}

void Predictor::advance(const ImuBuffer& imu) {
  if (imu.empty()) return;
  imu.for_each_step(state_.time, imu.newest().time,
                    [this](const ImuStep& step) { integrate(step, gravity_, state_); });
}

}  // namespace rio

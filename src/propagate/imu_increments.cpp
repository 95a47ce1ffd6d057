// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/imu_increments.hpp"

#include "rio/propagate/strapdown.hpp"

namespace rio {

ImuIncrements imu_increments(Time from, Time to, const NavState& biases, const ImuBuffer& imu) {
  NavState moved;
  moved.gyro_bias = biases.gyro_bias;
  moved.accel_bias = biases.accel_bias;
  imu.for_each_step(from, to, [&](const ImuStep& step) { integrate(step, 0.0, moved); });
  return {to_seconds(to - from), moved.q_WB.toRotationMatrix(), moved.v_WB, moved.p_WB};
}

}  // namespace rio

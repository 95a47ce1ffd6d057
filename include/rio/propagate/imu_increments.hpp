// SPDX-License-Identifier: BSD-3-Clause
// What the IMU says of the motion between two times: no state but its biases is needed.
//
// With body axes at the earlier time a, and s seconds between the two:
// (E1) R = R_a D,  v = v_a + g s + R_a u,  p = p_a + v_a s + g s^2 / 2 + R_a w
// Compare smoother/preintegration.hpp, which adds covariance and derivatives by the biases.
#pragma once

#include "rio/propagate/imu_buffer.hpp"
#include "rio/types.hpp"

namespace rio {

/// (E1)
struct ImuIncrements {
  double seconds = 0.0;                  ///< s
  Matrix3d turn = Matrix3d::Identity();  ///< D
  Vector3d velocity = Vector3d::Zero();  ///< u [m/s]
  Vector3d position = Vector3d::Zero();  ///< w [m]
};

/// @param biases state whose biases correct the samples
/// @param imu holds the samples from `from` to `to`
ImuIncrements imu_increments(Time from, Time to, const NavState& biases, const ImuBuffer& imu);

}  // namespace rio

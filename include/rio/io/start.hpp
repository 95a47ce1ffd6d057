// SPDX-License-Identifier: BSD-3-Clause
// A given first state with its covariance: from the start options, or from a file (`--init FILE`).
#pragma once

#include <filesystem>

#include "rio/options.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/types.hpp"

namespace rio::io {

/// Covariance of a start with the sigmas of `start`. Yaw and tilt are about world axes, so the body
/// block is R^T diag(tilt^2, tilt^2, yaw^2) R.
BodyCovariance start_covariance(const Quaternion& q_WB, const StartOptions& start);

/// Reads position [m], quaternion_wxyz, velocity [m/s], gyro_bias [rad/s], accel_bias [m/s^2],
/// time_ns and sigma: {position, orientation, velocity, gyro_bias, accel_bias}, each a number or a
/// list of three, one sigma per axis, orientation about body axes. Values take units as option
/// files do. quaternion_wxyz and velocity are required; position and biases default to zero, sigmas
/// to `start`.
/// @param default_time of the state when the file has no time_ns
/// @throws std::runtime_error "FILE:LINE: ..." for unknown keys, wrong types and units
Alignment load_start(const std::filesystem::path& path, const StartOptions& start,
                     Time default_time);

}  // namespace rio::io

// SPDX-License-Identifier: BSD-3-Clause
// Loosely coupled use of a scan: the least-squares velocity of its static set as one measurement of
// the velocity of a point of the body (Doer and Trommer 2020).
//
// (E1) Sigma_v = s^2 A^-1, A = sum u u^T over the static set of n points; s^2 = sum e^2 / (n - 3)
//      of their residuals e, but not below the configured Doppler noise: five points may agree by
//      chance
#pragma once

#include <optional>

#include "rio/frontend/ego_velocity.hpp"
#include "rio/models/aiding_measurement.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// (E1) in radar axes [m^2/s^2]. None: no consensus, three points or fewer, or all in a plane.
std::optional<Matrix3d> residual_covariance(const DetectionList& scan, const EgoVelocity& set);

/// The velocity of the radar as a measurement at the time of the estimate x, to which the scan
/// belongs, with the noise of the gyro sample on the lever from IMU to radar. None as above.
std::optional<AidingMeasurement> ego_velocity_measurement(const DetectionList& scan,
                                                          const EgoVelocity& set,
                                                          const Estimate& x);

}  // namespace rio

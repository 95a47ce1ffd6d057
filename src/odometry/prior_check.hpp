// SPDX-License-Identifier: BSD-3-Clause
// Checks of an initial state and its covariance, and the inflation after a jump of the clock.
#pragma once

#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio {

/// Every value is a number.
bool is_finite(const NavState& state);
/// Values and sigmas are within generous limits, so that arithmetic does not overflow.
bool is_plausible(const NavState& state, const BodyCovariance& P);
/// Its norm is between 0.5 and 2.
bool is_near_unit(const Quaternion& q);
/// Symmetric and positive semi-definite, both up to round-off, independent of units.
bool is_covariance(const BodyCovariance& P);
/// Inflates P by the possible motion in a pause of unknown length, some 0.3 s.
/// @param speed of the body [m/s]
void add_unknown_pause(const ImuOptions& imu, double speed, BodyCovariance& P);

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// What a state and its covariance must be to start from, and what a restart of the clock adds.
#pragma once

#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio {

/// Every value is a number.
bool is_finite(const NavState& state);
/// Neither a value nor a sigma is beyond what any vehicle has, so that arithmetic does not
/// overflow.
bool is_plausible(const NavState& state, const BodyCovariance& P);
/// Its norm is between 0.5 and 2.
bool is_near_unit(const Quaternion& q);
/// Symmetric, and no eigenvalue below zero, both but for round-off, whatever the units.
bool is_covariance(const BodyCovariance& P);
/// A pause of unknown length, some 0.3 s, added to P: how far the body may have moved and turned.
void add_unknown_pause(const ImuOptions& imu, double speed, BodyCovariance& P);

}  // namespace rio

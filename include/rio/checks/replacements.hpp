// SPDX-License-Identifier: BSD-3-Clause
// What a check replaces in the state estimate, and by how much it inflates the covariance for the
// possible causes and effects of the error. A back-end applies them through replace().
#pragma once

#include "rio/checks/correction_check.hpp"
#include "rio/checks/tilt_check.hpp"
#include "rio/checks/velocity_check.hpp"
#include "rio/options.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

/// Replaces the velocity. The difference was the error for `duration` [s], which also corrects the
/// position, and possibly for `doubtful` [s], which inflates the covariance of the position.
void replace_velocity(const IndependentVelocity& found, double duration, double doubtful,
                      StateEstimate* state_estimate);

/// Replaces the tilt so that gravity is the one found; the estimated velocity is kept in body axes.
/// The error was present for `duration` [s]. Inflates the covariance of attitude, gyro bias and
/// accelerometer bias by the possible causes, that of the position by the possible effect.
void replace_tilt(const IndependentGravity& found, double duration, const Options& options,
                  StateEstimate* state_estimate);

/// The gyro bias has stepped about the vertical: inflates its covariance, and that of heading,
/// velocity and position by the effect over the window.
void widen_heading(const LastingError& found, StateEstimate* state_estimate);

/// The velocity has drifted for a while, as after a step of a bias: the biases may be again what
/// they may be where nobody has measured them. Inflates their covariance, and that of attitude,
/// velocity and position by the effect over the window.
void widen_biases(const LastingError& found, const Options& options, StateEstimate* state_estimate);

/// Inflates the covariance of the position by sigma per axis [m].
void widen_position(double sigma, StateEstimate* state_estimate);

/// The clock of radar r has stepped by what its arrivals show: inflates its time offset.
void widen_time_offset(std::size_t r, StateEstimate* state_estimate);

/// The static alignment was of a body in motion, now of that speed [m/s]. The mean rate was no
/// bias: the gyro bias is unknown as after a start in motion. The mean specific force was not
/// gravity alone: inflates the covariance of the attitude by the acceleration.
void withdraw_alignment(double speed, const Options& options, StateEstimate* state_estimate);

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The calibration of one radar as a vector, in the order of `Calibration` (report.hpp), which is
// that of its columns in the error state: rotation vector and translation of T_BS, Doppler scale,
// time offset. With the auxiliary states they are the parameters, states without dynamics: each
// starts from a prior and is a random walk.
#pragma once

#include <Eigen/Core>

#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"

namespace rio {

/// Corrections of a calibration [rad, m, 1, s].
using CalibrationVector = Eigen::Matrix<double, static_cast<int>(kCalibrationCount), 1>;

/// The priors, 0 = not estimated.
CalibrationVector calibration_sigmas(const CalibrationOptions& options);

/// The calibration as configured.
inline RadarState configured_state(const RadarMount& mount) {
  return {mount.T_BS, mount.doppler_scale, mount.time_offset};
}

/// The calibration with the corrections applied: R <- R Exp(c_rotation), all else is added.
RadarState corrected(const RadarState& from, const CalibrationVector& corrections);
/// The corrections that lead from one calibration to another; the inverse of corrected().
CalibrationVector corrections_between(const RadarState& from, const RadarState& to);

/// The column of parameter i of the selected radar in the error state, -1 = not estimated.
int calibration_column(const Layout& layout, int i);

/// Of each column from body::kSize to the first clone; 0 where a parameter is not estimated.
struct ParameterNoise {
  Eigen::VectorXd prior;  ///< variance at the start [unit^2]
  Eigen::VectorXd walk;   ///< variance of the random walk per time [unit^2/s]
};

/// The walk of the calibration does not depend on the prior: a parameter that is known better
/// drifts as much.
ParameterNoise parameter_noise(const Layout& layout, const CalibrationOptions& calibration,
                               const AuxiliaryStates& auxiliary = {});

}  // namespace rio

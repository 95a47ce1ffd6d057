// SPDX-License-Identifier: BSD-3-Clause
// States without dynamics: the calibration of each radar and the auxiliary states. Each starts from
// a prior and is a random walk.
#pragma once

#include <Eigen/Core>

#include "rio/options.hpp"
#include "rio/state/layout.hpp"

namespace rio {

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

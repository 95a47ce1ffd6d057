// SPDX-License-Identifier: BSD-3-Clause
// Stage 6 of the EKF: the covariance of the standard error, after a correction of the mean, chosen
// so that the right-invariant error keeps its own: yaw and position about the world then stay
// unobservable although the linearisation points have moved.
//
// (E1) theta <- R+^T R- theta;  dp <- dp - [p+ - p-] R- theta, likewise v and landmarks;
//      a clone's own rotation error carries the clone;  P <- M P M^T
// Reference: Hao, Tian and He 2025 (transformation of the error state after each correction).
#pragma once

#include <Eigen/Core>

#include "rio/state/estimate.hpp"
#include "rio/update/covariance.hpp"

namespace rio {

/// (E1): the errors of `before` re-expressed for `after`, the same state after a correction.
void reexpress(const Layout& layout, const Estimate& before, const Estimate& after,
               Covariance* covariance);

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Stage 6 of the EKF: the covariance of the standard error, after a correction of the mean, chosen
// so that the right-invariant error keeps its own: yaw and position about the world then stay
// unobservable although the linearisation points have moved.
//
// (E1) theta <- R+^T R- theta;  dp <- dp - [p+ - p-] R- theta, likewise v and landmarks;
//      a clone's own rotation error carries the clone
// (E2) So P <- (I + U E^T) P (I + U E^T)^T = P + U V^T + V U^T, V = P E + U (E^T P E) / 2, where E
//      selects theta; for each theta in turn
// Reference: Hao, Tian and He 2025 (transformation of the error state after each correction).
#pragma once

#include <Eigen/Core>

#include "rio/state/estimate.hpp"
#include "rio/update/covariance.hpp"

namespace rio {

class Reexpression {
 public:
  /// @param capacity columns of the error state
  explicit Reexpression(int capacity);

  /// (E1): the errors of `before` re-expressed for `after`, the same state after a correction; on
  /// the lower triangle of the covariance.
  void apply(const Layout& layout, const Estimate& before, const Estimate& after,
             Covariance* covariance);

 private:
  /// (E2) on the lower triangle.
  void transform(int theta, Eigen::Ref<Eigen::MatrixXd> P);

  Eigen::Matrix<double, Eigen::Dynamic, 3> U_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> V_;
  Eigen::VectorXd combined_;  ///< sum of columns
};

}  // namespace rio

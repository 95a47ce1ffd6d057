// SPDX-License-Identifier: BSD-3-Clause
// Stage 5 of the EKF: observability constraint. After a correction of the mean, the covariance of
// the standard error is re-expressed so that that of the right-invariant error is unchanged: global
// yaw and position then stay unobservable although the linearisation points have moved. (This
// replaces first-estimate Jacobians, FEJ.)
//
// (E1) theta <- R+^T R- theta;  dp <- dp - [p+ - p-] R- theta, likewise v and landmarks;
//      the position of a clone is transformed by the clone's own rotation error
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

  /// (E1): re-expresses the errors of `before` for `after`, the state after a correction; reads and
  /// writes the lower triangle of the covariance.
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

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/state/blocks.hpp"

namespace rio {

RigidPose::RigidPose(const Pose& pose) : R(pose.rotation.toRotationMatrix()), p(pose.translation) {}

RigidPose PoseBlock::retract(const RigidPose& x, const Eigen::Matrix<double, kDof, 1>& error) {
  return {x.R * gamma(0, error.head<3>()), x.p + error.tail<3>()};
}

}  // namespace rio

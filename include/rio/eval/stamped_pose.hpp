// SPDX-License-Identifier: BSD-3-Clause
// One sample of a trajectory, for evaluation and trajectory files. Frames W and B.
#pragma once

#include <vector>

#include "rio/types.hpp"

namespace rio::eval {

/// Pose of the body in the world at one instant.
struct StampedPose {
  Time time{0};
  Vector3d p = Vector3d::Zero();          ///< p_WB [m]
  Quaternion q = Quaternion::Identity();  ///< q_WB, unit
};

/// Samples of one trajectory, by increasing time.
using Trajectory = std::vector<StampedPose>;

}  // namespace rio::eval

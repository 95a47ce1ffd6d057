// SPDX-License-Identifier: BSD-3-Clause
// A recorded path as an exact trajectory: the quintic B-spline of trajectory.hpp fitted to poses.
// Sensor data are then computed from the spline, never from the noisy samples.
//
// (E1) min sum_i |x(t_i) - z_i|^2 + w sum_k |c_k+3 - 3 c_k+2 + 3 c_k+1 - c_k|^2, z = position, yaw:
//      least squares with a penalty on the jerk. The first five controls are one unknown and so
//      are the last five, hence rest at both ends.
// (E2) yaw of trajectory.hpp: x_C is normal to y_B, so yaw = atan2(-y_B.x, y_B.y), unwrapped.
// (E3) w = 1e-4 samples a knot. For a motion of period T, samples a knot cancel and the fit is too
//      small by the share 1e-4 (2 sin(pi h/T))^6 / sinc(h/T)^12, h = knot spacing: 3e-5 at 8 h,
//      0.3 % at 4 h, less than recordings resolve. Where samples are missing, in a gap and in the
//      leads, the penalty alone decides: least jerk.
// Reference: Eilers and Marx, Statistical Science 1996 (E1).
//
// A vehicle recorded in flight gets a lead before the first and after the last sample, which
// accelerates it from rest and back; the standstill is where least jerk puts it, at the first
// sample if the recording starts at rest.
// Attitude is not fitted: it follows from the thrust, as in a random flight. The recorded tilt
// differs by what thrust does not explain: drag, wind, an IMU that is not mounted level (EuRoC's
// leans by 20 deg in pitch; without that, tilt agrees to about 1 deg).
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "rio/eval/stamped_pose.hpp"
#include "rio/sim/path.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// A recorded path as a trajectory, with its relation to the recording.
struct TrajectoryFit {
  Trajectory trajectory;
  Pose T_RW;  ///< pose of the flight's world W in the world of the recording [m]
  Quaternion q_FB = Quaternion::Identity();  ///< recorded body axes to forward-left-up axes
  double first = 0.0;  ///< time of the first recorded pose after the start of the trajectory [s]
  double rms = 0.0;    ///< of the distance from the samples to the spline [m]
};

/// Fits a recorded path (world z up; the body mounted in any of the six upright orientations) and
/// puts it between two standstills; it starts at the origin of W, level, at yaw 0. Frame B of the
/// trajectory: the nearest forward-left-up axes of the recorded body.
/// @param options fit_spacing, stand_before and stand_after are used. The default spacing of 0.2 s
///   follows motions up to 2.5 Hz, beyond what a small quadrotor's position does, and averages
///   over the noise of recordings of 20 Hz and more
/// @param start stamp of the start
/// @throws std::runtime_error for fewer than 10 poses, less than 2 s, stamps that do not increase,
/// numbers that are not finite, no upright axis, or a path that cannot be flown by thrust
TrajectoryFit fit_trajectory(const std::vector<eval::StampedPose>& poses,
                             const PathOptions& options = {}, Time start = Time(0));

}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
// A vehicle that turns and accelerates as its IMU says, seen by its radar in scans of a few points.
#pragma once

#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/state/estimate.hpp"
#include "support/random_state.hpp"

namespace rio::test {

class SeenVehicle {
 public:
  SeenVehicle(const Options& options, const Vector3d& v_W, Random* random);

  const ImuBuffer& imu() const { return imu_; }

  /// A scan later, of ten IMU samples.
  void advance();

  /// The truth as an estimate.
  Estimate estimate() const;

  /// `points` of the world and `others` that move by `u_W` in it.
  DetectionList scan(int points, int others = 0, const Vector3d& u_W = Vector3d::Zero()) {
    return scan_of(0, points, others, u_W);
  }
  /// What another radar sees, mounted as the first.
  DetectionList scan_of(std::size_t radar, int points, int others, const Vector3d& u_W);

  NavState truth;
  Vector3d rate{0.1, -0.2, 0.3};                 ///< [rad/s]
  Vector3d acceleration{0.3, 0.2, 0};            ///< axes W [m/s^2]
  Vector3d gyro_error = Vector3d::Zero();        ///< of the samples [rad/s]
  Vector3d accel_error = Vector3d::Zero();       ///< same [m/s^2]
  Quaternion mounting = Quaternion::Identity();  ///< unknown turn of the radar, axes B

 private:
  ImuSample sample() const;

  Options options_;
  ImuBuffer imu_;
  Random* random_;
};

}  // namespace rio::test

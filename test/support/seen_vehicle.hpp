// SPDX-License-Identifier: BSD-3-Clause
// A vehicle that turns and accelerates as its IMU says, seen by its radar in scans of a few points.
#pragma once

#include <cmath>

#include "rio/frontend/doppler_fold.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/state/estimate.hpp"
#include "support/random_state.hpp"

namespace rio::test {

class SeenVehicle {
 public:
  SeenVehicle(const Options& options, const Vector3d& v_W, Random* random)
      : options_(options), imu_(TimingOptions{}, options.imu), random_(random) {
    truth.q_WB = random_->rotation();
    truth.v_WB = v_W;
    imu_.push_back(sample());
  }

  const ImuBuffer& imu() const { return imu_; }

  /// A scan later, of ten IMU samples.
  void advance() {
    for (int i = 0; i < 10; ++i) {
      const ImuSample s = sample();
      integrate(s.gyro_B, s.accel_B, 0.0066, options_.imu.gravity, truth);
      truth.time += std::chrono::microseconds(6600);
      imu_.push_back({truth.time, s.gyro_B + gyro_error, s.accel_B + accel_error});
    }
  }

  /// The truth as an estimate.
  Estimate estimate() const {
    Estimate x;
    x.nav = truth;
    x.T_BS = options_.radar.T_BS;
    x.gyro_B = imu_.newest().gyro_B;
    return x;
  }

  /// `points` of the world and `others` that move by `u_W` in it.
  DetectionList scan(int points, int others = 0, const Vector3d& u_W = Vector3d::Zero()) {
    return scan_of(0, points, others, u_W);
  }
  /// What another radar sees, mounted as the first.
  DetectionList scan_of(std::size_t radar, int points, int others, const Vector3d& u_W) {
    const RadarOptions seen_by = options_.radar_of(radar);
    DetectionList out;
    out.time = truth.time;
    out.radar = radar;
    const Matrix3d R = truth.q_WB.toRotationMatrix();
    const Matrix3d R_BS = mounting.toRotationMatrix() * options_.radar.T_BS.rotation;
    const Vector3d turn = rate.cross(options_.radar.T_BS.translation);
    for (int i = 0; i < points + others; ++i) {
      const double az = random_->uniform(-1.0, 1.0);
      const double el = random_->uniform(-0.6, 0.6);
      const Vector3d point_S =
          3.0 * Vector3d(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      Vector3d v_B = R.transpose() * truth.v_WB + turn;
      if (i >= points) v_B -= R.transpose() * u_W;
      const double d = -(R_BS * point_S.normalized()).dot(v_B) + random_->normal(0.03);
      const double range_rate = DopplerFold(seen_by.max_doppler).wrap(d);
      out.items.push_back(make_detection({point_S, range_rate}, seen_by));
    }
    return out;
  }

  NavState truth;
  Vector3d rate{0.1, -0.2, 0.3};                 ///< [rad/s]
  Vector3d acceleration{0.3, 0.2, 0};            ///< axes W [m/s^2]
  Vector3d gyro_error = Vector3d::Zero();        ///< of the samples [rad/s]
  Vector3d accel_error = Vector3d::Zero();       ///< same [m/s^2]
  Quaternion mounting = Quaternion::Identity();  ///< unknown turn of the radar, axes B

 private:
  ImuSample sample() const {
    const Vector3d f_W = acceleration + Vector3d(0.0, 0.0, options_.imu.gravity);
    return {truth.time, rate, truth.q_WB.conjugate() * f_W};
  }

  Options options_;
  ImuBuffer imu_;
  Random* random_;
};

}  // namespace rio::test

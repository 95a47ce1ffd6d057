// SPDX-License-Identifier: BSD-3-Clause
// Stage 3 for other sensors: position, heading, velocity, height and range to the ground, for
// Odometry::add_measurement (rio/aiding.hpp). W is the world frame of the estimate: measurements of
// GNSS or motion capture must be transformed to it. Sigmas must be positive, covariances positive
// definite and symmetric up to round-off: otherwise add_measurement() returns kNumerical. C++17.
#pragma once

#include <cmath>

#include "rio/core/so3.hpp"
#include "rio/models/aiding_measurement.hpp"

namespace rio {

/// Position of a point of the body: p_W + R_WB l_B.
struct PositionModel {
  static constexpr const char* kName = "position";
  static constexpr int kDim = 3;
  using Blocks = BlockList<BodyPose>;
  struct Measurement {
    Vector3d p_W = Vector3d::Zero();               ///< [m]
    Matrix3d covariance_W = Matrix3d::Identity();  ///< [m^2]
    Vector3d lever_B = Vector3d::Zero();           ///< from the IMU to the point [m]
  };
  static bool is_valid(const Measurement& z) { return is_definite(z.covariance_W); }
  bool evaluate(const Measurement& z, const RigidPose& T_WB, Vector3d& r,
                Eigen::Matrix<double, 3, 6>* J, Matrix3d& R) const {
    r = z.p_W - T_WB.p - T_WB.R * z.lever_B;
    if (J != nullptr) *J << -T_WB.R * skew(z.lever_B), Matrix3d::Identity();
    R = z.covariance_W;
    return true;
  }
};

/// Heading of the body's x axis about the world's z axis. Domain: elevation of x below 80 degrees.
struct HeadingModel {
  static constexpr const char* kName = "heading";
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose>;
  struct Measurement {
    double heading = 0.0;  ///< [rad], modulo 2 pi
    double sigma = 1.0;    ///< [rad]
  };
  static bool is_valid(const Measurement& z) { return z.sigma > 0.0; }
  bool evaluate(const Measurement& z, const RigidPose& T_WB, Eigen::Matrix<double, 1, 1>& r,
                Eigen::Matrix<double, 1, 6>* J, Eigen::Matrix<double, 1, 1>& R) const {
    const double x = T_WB.R(0, 0);
    const double y = T_WB.R(1, 0);
    const double square = x * x + y * y;
    constexpr double kLevel = 0.03;  // cos^2 of 80 degrees
    if (square < kLevel) return false;
    r[0] = std::remainder(z.heading - std::atan2(y, x), 2.0 * kPi);
    if (J != nullptr) {
      const Matrix3d d_x = -T_WB.R * skew(Vector3d::UnitX());  // of R e_x by dphi
      J->setZero();
      J->head<3>() = (x * d_x.row(1) - y * d_x.row(0)) / square;
    }
    R(0, 0) = z.sigma * z.sigma;
    return true;
  }

 private:
  static constexpr double kPi = 3.14159265358979323846;
};

/// Velocity of a point of the body, in body axes: R_WB^T v_WB + (gyro - b_g) x l_B.
struct BodyVelocityModel {
  static constexpr const char* kName = "velocity_body";
  static constexpr int kDim = 3;
  using Blocks = BlockList<BodyPose, BodyVelocity, GyroBias>;
  struct Measurement {
    Vector3d v_B = Vector3d::Zero();               ///< [m/s]
    Matrix3d covariance_B = Matrix3d::Identity();  ///< [m^2/s^2]
    Vector3d lever_B = Vector3d::Zero();           ///< from the IMU to the point [m]
    Vector3d gyro_B = Vector3d::Zero();  ///< measured at its time, if there is a lever [rad/s]
  };
  static bool is_valid(const Measurement& z) { return is_definite(z.covariance_B); }
  bool evaluate(const Measurement& z, const RigidPose& T_WB, const Vector3d& v_WB,
                const Vector3d& gyro_bias, Vector3d& r, Eigen::Matrix<double, 3, 12>* J,
                Matrix3d& R) const {
    const Vector3d v_B = T_WB.R.transpose() * v_WB;
    r = z.v_B - v_B - (z.gyro_B - gyro_bias).cross(z.lever_B);
    if (J != nullptr) {
      *J << skew(v_B), Matrix3d::Zero(), T_WB.R.transpose(), skew(z.lever_B);
    }
    R = z.covariance_B;
    return true;
  }
};

/// Velocity of the IMU, in world axes.
struct WorldVelocityModel {
  static constexpr const char* kName = "velocity_world";
  static constexpr int kDim = 3;
  using Blocks = BlockList<BodyVelocity>;
  struct Measurement {
    Vector3d v_W = Vector3d::Zero();               ///< [m/s]
    Matrix3d covariance_W = Matrix3d::Identity();  ///< [m^2/s^2]
  };
  static bool is_valid(const Measurement& z) { return is_definite(z.covariance_W); }
  bool evaluate(const Measurement& z, const Vector3d& v_WB, Vector3d& r, Matrix3d* J,
                Matrix3d& R) const {
    r = z.v_W - v_WB;
    if (J != nullptr) J->setIdentity();
    R = z.covariance_W;
    return true;
  }
};

/// Barometric height minus height over the start [m]: drifts with the weather and with the
/// temperature of the sensor.
struct HeightOffset : AuxiliaryBlock<1> {
  static constexpr const char* kName = "height_offset";
  static constexpr double kSigma = 2.0;
  static constexpr double kWalk = 0.02;
};
/// Height of the IMU over the start plus a slowly drifting offset.
struct HeightModel {
  static constexpr const char* kName = "height";
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, HeightOffset>;
  struct Measurement {
    double height = 0.0;  ///< [m]
    double sigma = 1.0;   ///< [m]
  };
  static bool is_valid(const Measurement& z) { return z.sigma > 0.0; }
  using Scalar = Eigen::Matrix<double, 1, 1>;
  bool evaluate(const Measurement& z, const RigidPose& T_WB, const Scalar& offset, Scalar& r,
                Eigen::Matrix<double, 1, 7>* J, Scalar& R) const {
    r[0] = z.height - T_WB.p.z() - offset[0];
    if (J != nullptr) *J << 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0;
    R(0, 0) = z.sigma * z.sigma;
    return true;
  }
};

/// Height of the ground below the vehicle, in W [m].
struct GroundHeight : AuxiliaryBlock<1> {
  static constexpr const char* kName = "ground_height";
  static constexpr double kSigma = 0.5;
  static constexpr double kWalk = 0.1;
};
/// Range to level ground along an axis of the body. Domain: within 60 degrees of straight down.
struct GroundRangeModel {
  static constexpr const char* kName = "ground_range";
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, GroundHeight>;
  struct Measurement {
    double range = 0.0;                       ///< [m]
    double sigma = 1.0;                       ///< [m]
    Vector3d direction_B = {0.0, 0.0, -1.0};  ///< of the beam, unit
    Vector3d lever_B = Vector3d::Zero();      ///< from the IMU to the sensor [m]
  };
  static bool is_valid(const Measurement& z) { return z.sigma > 0.0; }
  using Scalar = Eigen::Matrix<double, 1, 1>;
  bool evaluate(const Measurement& z, const RigidPose& T_WB, const Scalar& ground, Scalar& r,
                Eigen::Matrix<double, 1, 7>* J, Scalar& R) const {
    const double down = -(T_WB.R * z.direction_B).z();
    if (down < 0.5) return false;
    const double height = T_WB.p.z() + (T_WB.R * z.lever_B).z() - ground[0];
    const double range = height / down;
    r[0] = z.range - range;
    if (J != nullptr) {
      const Eigen::RowVector3d d_lever = -(T_WB.R * skew(z.lever_B)).row(2);
      const Eigen::RowVector3d d_down = (T_WB.R * skew(z.direction_B)).row(2);
      *J << (d_lever - range * d_down) / down, 0.0, 0.0, 1.0 / down, -1.0 / down;
    }
    R(0, 0) = z.sigma * z.sigma;
    return true;
  }
};

}  // namespace rio

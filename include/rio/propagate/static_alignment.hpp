// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: the first state from a standstill: roll and pitch from gravity, gyro bias from the mean
// rate, and a covariance that knows how the tilt depends on the accelerometer bias. Any IMU
// mounting.
//
// With f the mean specific force, y = f/|f| (up in body axes), b_a the accelerometer bias:
// (E1) R y = e_z, yaw 0;  b_g = mean rate;  b_a = y (|f| - g), shrunk by its prior
// (E2) [y] theta = -b_a_perp / g   =>   theta_perp = [y] b_a / g
// (E3) P_aa = sigma_ba^2 (I - y y^T) + s^2 y y^T,  P_theta,a = [y] P_aa / g,
//      P_theta,theta = [y] P_aa [y]^T / g^2 + (noise/g)^2 (I - y y^T) + sigma_yaw^2 y y^T
// where s^2 is the posterior variance of b_a along y given |f| - g and the spread of local gravity.
// Derivation: f = g exp(-theta) y_true + b_a + n to first order.
#pragma once

#include <optional>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio {

/// Result of the alignment.
struct Alignment {
  NavState state;
  BodyCovariance covariance = BodyCovariance::Zero();
};

/// A rotation that takes the up direction y (body) to e_z. Heading zero: the x axis points along
/// the world's x, or, where it is vertical, the y axis along the world's y.
Quaternion level(const Vector3d& y);

/// Averages samples until `StartOptions::duration` is covered, then decides. O(1) memory: the
/// window is split in two halves, whose means must agree, so that slow motion is noticed too.
class StaticAligner {
 public:
  StaticAligner(const StartOptions& start, const ImuOptions& imu) : start_(start), imu_(imu) {}

  void reset() { halves_[0] = halves_[1] = Half{}; }

  /// kOk: more samples are needed, or `result` holds the alignment; kMoving: the window that just
  /// ended was not a standstill, and a new one begins.
  Status add(const ImuSample& sample, std::optional<Alignment>* result);

 private:
  /// Running mean and sum of squares (Welford 1962).
  struct Half {
    double count = 0.0;
    Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
    Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();

    void add(const ImuSample& s);
    Eigen::Matrix<double, 6, 1> deviation() const { return (squares / (count - 1.0)).cwiseSqrt(); }
  };

  bool standstill() const;

  Alignment align(Time time) const;

  static constexpr double kGravitySpread = 0.02;  // [m/s^2]
  static constexpr double kGyroBiasFloor = 1e-4;  // instability of a MEMS gyro over minutes [rad/s]
  static constexpr double kStillVelocity = 0.01;  // what passes for standing [m/s]

  StartOptions start_;
  ImuOptions imu_;
  Time begin_{0};
  Half halves_[2];
};

/// The gyro bias if the first `StartOptions::duration` of `samples` from `from` on is a standstill.
std::optional<Vector3d> standstill_gyro_bias(const std::vector<ImuSample>& samples, Time from,
                                             const Options& options);

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// The integrated IMU: C and s of motion.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "rio/types.hpp"

namespace rio::check {

/// Only sparse points and the latest parts are stored:
/// access must be in the order of time.
class ImuPath {
 public:
  struct Point {
    Quaternion turn = Quaternion::Identity();  ///< C
    Vector3d sum = Vector3d::Zero();           ///< s [m/s]
    Vector3d rate = Vector3d::Zero();          ///< w [rad/s]
    int piece = 0;                             ///< changes at pauses of the IMU
  };
  /// @param samples stamps strictly increasing; they outlive the path
  /// @param gyro_unit by which the rates are multiplied
  ImuPath(const std::vector<ImuSample>& samples, const Matrix3d& gyro_unit, double accel_unit)
      : samples_(samples), gyro_unit_(gyro_unit), accel_unit_(accel_unit) {}
  ImuPath(const std::vector<ImuSample>& samples, double gyro_unit, double accel_unit)
      : ImuPath(samples, Matrix3d(gyro_unit * Matrix3d::Identity()), accel_unit) {}
  /// Empty outside of the samples.
  std::optional<Point> at(Time time) const;

 private:
  static constexpr std::size_t kPart = 128;  ///< points from one stored point to the next
  static constexpr std::size_t kParts = 16;  ///< number of stored parts: a second or more

  /// The points at the samples from k * kPart on, the first of the next part included, each with
  /// the rate of the interval that begins there.
  const std::vector<Point>& part(std::size_t k) const;
  /// From the point at sample i - 1 to that at i.
  void advance(std::size_t i, Point* now) const;

  const std::vector<ImuSample>& samples_;
  Matrix3d gyro_unit_;
  double accel_unit_;
  mutable std::vector<Point> marks_;  ///< at every kPart-th sample, as far as accessed
  struct Part {
    std::size_t k = static_cast<std::size_t>(-1);
    std::vector<Point> points;
  };
  mutable std::array<Part, kParts> parts_;  ///< part k in place k modulo kParts
};

}  // namespace rio::check

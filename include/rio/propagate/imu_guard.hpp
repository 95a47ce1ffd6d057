// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: rejects IMU samples that are not caused by motion; the pause they leave is bridged like
// one of lost samples.
//
// Out of range: a value outside the range of the sensor (ImuOptions::max_rate, max_accel), or an
// axis that repeats, to the last bit, the largest value it ever had: a smaller range, saturated.
// Frozen: all six values equal those of the sample before, although the noise hardly ever repeats.
#pragma once

#include <cstdint>

#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio {

enum class ImuFault : std::uint8_t { kNone, kOutOfRange, kFrozen };

class ImuGuard {
 public:
  explicit ImuGuard(const ImuOptions& imu) : max_rate_(imu.max_rate), max_accel_(imu.max_accel) {}

  void reset() { *this = ImuGuard(max_rate_, max_accel_); }

  /// Takes one more sample, which must be finite, and returns its fault.
  ImuFault check(const ImuSample& sample);

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  ImuGuard(double max_rate, double max_accel) : max_rate_(max_rate), max_accel_(max_accel) {}
  bool out_of_range(const Vector6d& x);

  static constexpr double kSmallestRate = 4.3;    // least range of a gyroscope, 250 deg/s [rad/s]
  static constexpr double kSmallestAccel = 19.0;  // same of an accelerometer, 2 g [m/s^2]
  static constexpr double kKnown = 100.0;         // samples until the share of repeats is known
  static constexpr double kRarely = 0.02;         // share of repeats; coarse quantisation has more

  double max_rate_;
  double max_accel_;
  Vector6d last_ = Vector6d::Zero();
  Vector6d largest_ = Vector6d::Zero();  ///< magnitude so far, within the range
  double seen_ = 0.0;                    ///< samples accepted
  double repeated_ = 0.0;                ///< of those, repeats
};

}  // namespace rio

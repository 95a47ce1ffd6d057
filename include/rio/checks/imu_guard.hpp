// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: rejects IMU samples that are not caused by motion; the pause they leave is bridged like
// one of lost samples.
//
// Out of range: a value outside the range of the sensor (ImuOptions::max_rate, max_accel), or an
// axis that repeats, to the last bit, the largest value it ever had: a smaller range, saturated.
// Frozen: values that repeat, to the last bit, where the noise does not. With r_i the largest share
// of repeats that axis i has had for some time, and n_i how often it has just repeated:
// (E1) prod r_i^n_i < 1e-9, over all six axes if all repeat, over the three of one sensor if the
//      other one varies, or for one axis if another of the same sensor does: at rest coarse sensors
//      may repeat all their values
// All six zero, once some were not: a read of the driver that failed.
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
  void count_repeats(const Vector6d& x);
  bool is_frozen() const;  ///< (E1)
  /// An axis of a sensor, 0 gyroscope or 1 accelerometer, varies; `but` this one.
  bool varies(int sensor, int but = -1) const;

  static constexpr double kSmallestRate = 4.3;    // least range of a gyroscope, 250 deg/s [rad/s]
  static constexpr double kSmallestAccel = 19.0;  // same of an accelerometer, 2 g [m/s^2]
  static constexpr double kKnown = 100.0;         // samples until the share of repeats is known
  static constexpr double kMemory = 200.0;        // samples over which it is averaged
  static constexpr double kRecent = 16.0;         // same, of the axes that vary
  static constexpr double kRarely = 0.02;         // share of repeats; coarse quantisation has more

  double max_rate_;
  double max_accel_;
  Vector6d last_ = Vector6d::Zero();
  Vector6d largest_ = Vector6d::Zero();          ///< magnitude so far, within the range
  double seen_ = 0.0;                            ///< samples accepted
  Vector6d repeats_ = Vector6d::Zero();          ///< n of (E1)
  Vector6d share_ = Vector6d::Zero();            ///< of repeats, of the samples accepted
  Vector6d most_ = Vector6d::Constant(kRarely);  ///< r of (E1): the largest share so far
  Vector6d recent_ = Vector6d::Zero();           ///< share of repeats, of the latest samples
};

}  // namespace rio

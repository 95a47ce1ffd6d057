// SPDX-License-Identifier: BSD-3-Clause
// Checks of the IMU alone: stamps, units, saturation. No motion model and no radar is needed.
//
// The unit of the accelerometer: at rest it measures g, in flight g on average.
// The unit of the gyro: it rotates the specific force of one second into that of the next. With
// rates too large by 57 the two directions are unrelated; with correct rates they agree up to the
// apparent tilt from acceleration.
// (E1) e(k) = median angle between f and the f of half a second ago, rotated by Exp(-k w dt)
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "check/finding.hpp"
#include "rio/io/dataset.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// Samples that can be integrated: finite, in_order() of order.hpp; empty if these are all.
std::optional<std::vector<ImuSample>> usable_if_not_all(const std::vector<ImuSample>& samples);

/// The second in which the specific force varies least.
struct Rest {
  Time begin{0};
  Time end{0};
  Vector3d accel = Vector3d::Zero();                        ///< mean, as recorded
  Vector3d gyro = Vector3d::Zero();                         ///< same
  double spread = std::numeric_limits<double>::infinity();  ///< of |f|, over its mean
  double turning = 0.0;  ///< rms deviation of the rate, as recorded
  /// The smallest mean of the specific force in any second: near zero if gravity was removed.
  double least = std::numeric_limits<double>::infinity();

  /// As still as with all engines off.
  bool is_quiet(double gyro_unit) const {
    constexpr double kGyro = 0.01;    // [rad/s]
    constexpr double kSpread = 0.02;  // of |f|
    return spread < kSpread && gyro_unit * turning < kGyro;
  }
};

struct ImuCheck {
  Findings findings;
  double stamp_unit = 1.0;  ///< of the stamps [ns]; else nothing more is known
  bool integrable = true;   ///< with these units; else what is wrong must be changed first
  bool exchanged = false;   ///< the columns of gyro and accelerometer
  double gyro_unit = 1.0;   ///< factor of the gyro to get [rad/s]
  double accel_unit = 1.0;  ///< factor of the accelerometer to get [m/s^2]
  Rest rest;
};

/// The IMU data for the other checks.
struct CheckedImu {
  const std::vector<ImuSample>& all;
  const std::vector<ImuSample>& good;  ///< usable_if_not_all(), else all
  const ImuCheck& check;
};

/// @param samples as recorded, in their order
/// @param good usable_if_not_all() of them, else all
/// @param csv their file, to name lines of it; may be empty
ImuCheck check_imu(const std::vector<ImuSample>& samples, const std::vector<ImuSample>& good,
                   const io::ImuInfo& info, Source source, const std::filesystem::path& csv);

/// With gyro and accelerometer exchanged.
std::vector<ImuSample> exchanged(std::vector<ImuSample> samples);

}  // namespace rio::check

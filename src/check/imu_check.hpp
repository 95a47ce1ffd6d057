// SPDX-License-Identifier: BSD-3-Clause
// Checks of the IMU alone: stamps, units, saturation, the standstill with which the estimator
// starts. No motion model and no radar is needed.
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
#include "check/scans.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

// How long the IMU can bridge missing data: the rules by which gaps are judged.

/// Largest uncertainty of velocity and tilt of an estimate that is ok; the limits of
/// HealthReason::kUncertainVelocity and kUncertainTilt.
inline constexpr double kMostVelocity = 0.5;        // [m/s]
inline constexpr double kMostTilt = 3.0 * kDegree;  // [rad]

/// The tilt in flight is known to about a degree, which causes this apparent acceleration.
inline constexpr double kFeigned = 0.17;  // [m/s^2]

/// A longer silence of the radar makes the velocity uncertain.
inline constexpr double kLongestSilence = kMostVelocity / kFeigned;  // [s]

/// Up to this interval of radar velocities the IMU adds less than the error of one of them.
inline constexpr double kSparseVelocities = 0.1 / kFeigned;  // [s]

/// The samples that can be integrated: finite, of a size that an IMU measures, in_order() of
/// order.hpp; without single ones that the estimator leaves out (checks/imu_guard.hpp). A copy only
/// if these are not all.
class Usable {
 public:
  /// @param all as recorded, in their order; outlive it
  explicit Usable(const std::vector<ImuSample>& all);
  const std::vector<ImuSample>& all() const { return all_; }
  const std::vector<ImuSample>& good() const { return fewer_ ? *fewer_ : all_; }
  /// Single ones that are zero in all axes, or beyond the range of the sensor.
  std::size_t spikes() const { return spikes_; }

 private:
  const std::vector<ImuSample>& all_;
  std::optional<std::vector<ImuSample>> fewer_;
  std::size_t spikes_ = 0;
};

/// Whether they differ in their stamps at most.
inline bool same_values(const ImuSample& a, const ImuSample& b) {
  return a.gyro_B == b.gyro_B && a.accel_B == b.accel_B;
}

/// Samples with the stamp of the one before.
struct Repeated {
  std::size_t count = 0;
  std::size_t twice = 0;  ///< of these, with its values, too
};
Repeated repeated(const std::vector<ImuSample>& samples);

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
  const std::vector<ImuSample>& good;  ///< the Usable ones
  const ImuCheck& check;
};

/// @param csv the file of the samples, to name lines of it; may be empty
ImuCheck check_imu(const Usable& samples, const io::ImuInfo& info, Source source,
                   const std::filesystem::path& csv);

// Its parts; each adds to `found`, and may use what those before it found.

/// Unit, rate and order of the stamps, and what the lost samples cost the estimate. At least two
/// good samples. In another unit the change is up to the caller.
Finding check_stamps(const Usable& samples, const io::ImuInfo& info, Source source,
                     const std::filesystem::path& csv, ImuCheck* found);

/// The unit of the accelerometer, or what else is in its columns.
/// @param samples usable ones
Finding check_accel(const std::vector<ImuSample>& samples, Source source, ImuCheck* found);

/// The unit of the gyro.
Finding check_gyro(const std::vector<ImuSample>& samples, Source source, ImuCheck* found);

/// Whether the estimator finds the standstill with which it starts, and what a late one costs;
/// subject "start".
/// @param scans of the first radar
Finding check_start(const CheckedImu& imu, const Scans& scans, const Options& options);

/// Empty if a barometer measures pressures of the air, or nothing.
std::optional<Finding> check_pressures(const std::vector<io::BaroSample>& baro);

}  // namespace rio::check

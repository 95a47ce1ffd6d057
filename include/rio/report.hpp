// SPDX-License-Identifier: BSD-3-Clause
// Reports of the estimator: the outcome of a call, and the record of the last update. The report is
// the log; fixed-size plain structs. C++17.
#pragma once

#include <array>
#include <cstdint>

#include "rio/core/static_vector.hpp"
#include "rio/export.hpp"
#include "rio/health.hpp"
#include "rio/types.hpp"

namespace rio {

/// Outcome of a call. All values but kOk, kWaiting and kNumerical leave the estimate unchanged.
/// What is refused for its data is counted in Counters, except by reset(); kMoving, kUndeclared and
/// a measurement before the start, or without a valid noise, are not.
enum class Status : std::uint8_t {
  kOk,
  kWaiting,         ///< queued: a scan newer than the IMU, or a measurement of another sensor
  kNotInitialized,  ///< no state yet: static alignment has not finished or reset() was not called
  kMoving,          ///< static alignment was refused because the sensor moves
  kStale,           ///< IMU sample not newer than the last one
  kDuplicate,       ///< a scan with this stamp, or these moving detections, was already taken
  kLate,            ///< scan older than the estimate, start older than the buffered samples
  kQueueFull,       ///< too many scans, or measurements of other sensors, wait
  kNonFinite,       ///< NaN or infinity in the data
  kNumerical,    ///< the update failed numerically: the estimate is the IMU prediction; for a start
                 ///< or a measurement of another sensor: no valid covariance, sigma or quaternion
  kImplausible,  ///< IMU sample frozen or out of range: treated as lost; for a start: beyond any
                 ///< vehicle
  kAhead,        ///< stamp too far ahead of the newest IMU sample
  kUndeclared,   ///< the options have no such radar, or not the auxiliary state of the measurement
};

/// Name of a status, as in "kLate".
RIO_API const char* to_string(Status status);

/// Measurement models that can appear in a record, in the order of ModelReport entries.
enum class Model : std::uint8_t {
  kDoppler,
  kTrailDistance,
  kLandmarkDistance,
  kLandmarkPoint,
  kLandmarkPosition,
  kRest,
  kAiding,       ///< of another sensor, InnovationRecord::name
  kEgoVelocity,  ///< the velocity of a scan's static set as one measurement
  kCount
};
inline constexpr std::size_t kModelCount = static_cast<std::size_t>(Model::kCount);

/// Name of a model, as in "doppler".
RIO_API const char* to_string(Model model);

/// Outcome of one measurement block.
enum class GateResult : std::uint8_t { kUsed, kGated, kOutOfDomain };

/// One measurement block at the linearisation point, before the update.
struct InnovationRecord {
  Model model = Model::kDoppler;
  GateResult result = GateResult::kUsed;
  /// Index in the filtered scan; of kAiding and kEgoVelocity in the measurements of the update; of
  /// kRest 0.
  std::uint16_t detection = 0;
  std::uint16_t dof = 0;  ///< rows of the block
  /// z - h(x) of its first row: of a model of one row in its unit [m/s, m], of several rows and of
  /// kAiding divided by the noise of the measurement [1].
  double innovation = 0.0;
  double sigma = 0.0;          ///< sqrt of the innovation variance of that row, in the same unit
  double nis = 0.0;            ///< normalised innovation squared of the block
  double gate = 0.0;           ///< threshold of the gate
  const char* name = nullptr;  ///< kAiding: of the model
};

/// What the estimator took a detection for.
enum class PointLabel : std::uint8_t {
  kUnused,   ///< undecided: no consensus or a doubtful one, or an ambiguous fold
  kStatic,   ///< its Doppler fits the static world
  kMatched,  ///< the same, and matched with a landmark, or with a trail whose distances are used
  kMover,    ///< fits the static world, but is part of a mover
  kOutlier,  ///< does not fit the static world
  kOwnEcho,  ///< echo of the vehicle itself
};
inline constexpr std::size_t kPointLabelCount = 6;

/// Name of a label, as in "own echo".
inline const char* to_string(PointLabel label) {
  constexpr std::array kNames = {"unused", "static", "matched", "mover", "outlier", "own echo"};
  return kNames[static_cast<std::size_t>(label)];
}

/// One detection of the filtered scan, seen from the estimate after the update.
struct PointReport {
  PointLabel label = PointLabel::kUnused;
  Vector3d point_S = Vector3d::Zero();  ///< corrected for the radar errors, radar frame [m]
  Vector3d point_W = Vector3d::Zero();  ///< by the estimated pose, world [m]
  double range_rate = 0.0;              ///< corrected and, if static, unfolded [m/s]
  double snr_db = 0.0;                  ///< [dB]
  double residual = 0.0;                ///< range rate minus that of a static point there [m/s]
  double residual_sigma = 0.0;          ///< of the noise of Doppler and direction [m/s]
};

/// A landmark of the state.
struct LandmarkReport {
  Vector3d position_W = Vector3d::Zero();    ///< [m]
  Matrix3d covariance_W = Matrix3d::Zero();  ///< marginal [m^2]
  Time last_seen{0};                         ///< time of the last match that was used
};

/// Sums over the records of one model in one update.
struct ModelReport {
  int rows_used = 0;
  int rows_gated = 0;
  int rows_out_of_domain = 0;  ///< measurements: these have no rows
  double nis = 0.0;  ///< sum over the blocks used; consistent noise makes it about rows_used
};

/// Observability of a calibration parameter.
enum class Observability : std::uint8_t {
  kNotEstimated,  ///< no prior was given: the option's value is used
  kUnobserved,    ///< no information so far: sigma above 90 % of its prior
  kWeak,          ///< sigma between 50 and 90 % of its prior
  kObserved,      ///< sigma below 50 % of its prior
  kDoubtful,      ///< observed, but beyond kCalibrationDoubt: the prior is wrong, or the parameter
                  ///< compensates an error without a model
  kAtLimit,       ///< the estimate has reached its limit: the prior, or the sensor, is wrong
};

/// Name as in reports.
inline const char* to_string(Observability observability) {
  constexpr std::array kNames = {"not estimated", "unobserved", "weak",
                                 "observed",      "doubtful",   "at its limit"};
  return kNames[static_cast<std::size_t>(observability)];
}

/// One parameter of the calibration.
struct CalibrationReport {
  double value = 0.0;        ///< estimate minus the option's value, in the unit of its Calibration
  double sigma = 0.0;        ///< that of the covariance [same]
  double prior_sigma = 0.0;  ///< [same]
  Observability observability = Observability::kNotEstimated;
};

/// Order of UpdateReport::calibration.
enum class Calibration : std::uint8_t {
  kRotationX,  ///< of T_BS, about the radar's axes [rad]
  kRotationY,
  kRotationZ,
  kTranslationX,  ///< of T_BS, body axes [m]
  kTranslationY,
  kTranslationZ,
  kDopplerScale,  ///< relative error of the range rates
  kTimeOffset,    ///< stamps late by [s]
};
inline constexpr std::size_t kCalibrationCount = 8;

/// The last update, stage by stage: of a scan, or, while the radar is silent, of measurements of
/// other sensors alone.
struct UpdateReport {
  static constexpr std::size_t kMaxRecords = 512;

  Time time{0};           ///< stamp of the scan
  std::size_t radar = 0;  ///< radar of the scan; `calibration` is that of this radar
  Status status = Status::kOk;
  int detections = 0;                          ///< in the scan as received
  int detections_kept = 0;                     ///< after the filter
  int static_detections = 0;                   ///< inliers of the ego-velocity consensus
  Vector3d ego_velocity_S = Vector3d::Zero();  ///< RANSAC estimate, radar frame [m/s]
  bool ego_velocity_valid = false;
  int trails = 0;  ///< alive after the update
  int trails_matched = 0;
  int clones = 0;
  int landmarks = 0;  ///< in the state after the update
  int landmarks_matched = 0;
  int landmarks_added = 0;
  int landmarks_removed = 0;
  int aiding_held = 0;                 ///< measurements held back for a delayed auxiliary state
  bool imu_gap = false;                ///< the propagation to this scan crossed a gap
  bool at_rest = false;                ///< standstill for a while, by IMU and radar
  bool mounting_unknown = false;       ///< of the radar: the scan served to find it, nothing else
  bool velocity_reset = false;         ///< the velocity was replaced before the update
  bool attitude_reset = false;         ///< tilt was replaced, or heading and gyro bias widened
  double position_reopened = 0.0;      ///< sigma added to the position after a doubtful time [m]
  double velocity_contradicted = 0.0;  ///< by the Dopplers of the last second, for this long [s]
  double tilt_contradicted = 0.0;      ///< by those of the last two seconds, for this long [s]
  Health health;                       ///< after the update
  Time propagation_time{0};            ///< time spent, if TimingOptions::clock is given
  Time update_time{0};                 ///< same, front-end to promotion
  std::array<ModelReport, kModelCount> models{};
  std::array<CalibrationReport, kCalibrationCount> calibration{};  ///< after the update
  StaticVector<InnovationRecord, kMaxRecords> records;
  int records_dropped = 0;  ///< blocks beyond kMaxRecords (still counted in `models`)
};

/// Running totals since create() or reset().
struct Counters {
  std::uint64_t imu_samples = 0;
  std::uint64_t imu_stale = 0;
  std::uint64_t imu_ahead = 0;
  std::uint64_t imu_non_finite = 0;
  std::uint64_t imu_out_of_range = 0;  ///< saturated, or beyond the range of any sensor
  std::uint64_t imu_frozen = 0;        ///< values that repeat where noise does not
  std::uint64_t imu_gaps = 0;
  std::uint64_t clock_restarts = 0;     ///< permanent jumps of the IMU clock
  std::uint64_t radar_clock_steps = 0;  ///< against that of the IMU; found and carried
  std::uint64_t scans = 0;              ///< processed
  std::uint64_t scans_late = 0;
  std::uint64_t scans_ahead = 0;
  std::uint64_t scans_duplicate = 0;
  std::uint64_t scans_overflow = 0;
  std::uint64_t scans_non_finite = 0;       ///< no finite detection although the scan was not empty
  std::uint64_t detections_non_finite = 0;  ///< or beyond the range of any radar
  std::uint64_t scans_uninitialized = 0;
  std::uint64_t aiding = 0;  ///< measurements of other sensors taken
  std::uint64_t aiding_late = 0;
  std::uint64_t aiding_ahead = 0;
  std::uint64_t aiding_overflow = 0;    ///< dropped, since too many are waiting
  std::uint64_t moving_starts = 0;      ///< without a standstill, see StartOptions::max_wait
  std::uint64_t updates_failed = 0;     ///< kNumerical
  std::uint64_t velocity_resets = 0;    ///< the scans contradicted the velocity for too long
  std::uint64_t attitude_resets = 0;    ///< same for gravity or landmarks: attitude or a bias
  std::uint64_t restarts = 0;           ///< the tilt was lost and recovered from the specific force
  std::uint64_t position_reopened = 0;  ///< times; see UpdateReport::position_reopened
};

}  // namespace rio

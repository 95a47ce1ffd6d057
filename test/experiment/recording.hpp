// SPDX-License-Identifier: BSD-3-Clause
// Real recordings without exact truth: found in a folder, perturbed, replayed as by a flight stack,
// and compared with the known references: a path, a flat floor or a barometer, the return to the
// start, the rest at the end.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "experiment/campaign.hpp"
#include "rio/eval/stamped_pose.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio::experiment {

/// A recording with the references of its path.
struct Recording {
  std::string name;
  std::string group;  ///< the folder it is in
  io::Dataset data;
  eval::Trajectory
      reference;       ///< of reference.tum or truth.tum, may be empty; heights used if all zero
  int first_seed = 1;  ///< of the RANSAC

  bool flat() const;
  /// A vehicle that stands all the time, by its name.
  bool stands() const { return name.rfind("static_", 0) == 0; }
};

/// Every folder below `folder` that holds imu0 and radar0, by name.
/// @throws std::runtime_error if there is none or one cannot be read
std::vector<Recording> find_recordings(const std::filesystem::path& folder);

/// First and last time of motion, by the radar; people near it do not count.
struct Motion {
  Time begin;
  Time end;
};
Motion motion_of(const io::Dataset& data);

/// A recording with a harmless fault.
struct Copy {
  std::string kind;
  Recording recording;
};

/// Copies with two seconds of rest before the start, with every other scan, with 30 % of the points
/// dropped, with the mounting configured wrong by 3 deg, and with stamps wrong by 20 ms.
/// @param draws number of the random ones
std::vector<Copy> perturbed(const Recording& recording, int draws, std::uint64_t seed);

/// The estimate at one scan.
struct RecordedStep {
  NavState state;
  Matrix3d P_position = Matrix3d::Zero();

  double sigma_height() const { return std::sqrt(P_position(2, 2)); }  ///< [m]
};

/// A replay with static start.
struct Replay {
  std::vector<RecordedStep> steps;                                 ///< empty if it did not start
  double seconds = 0.0;                                            ///< of the whole run
  HealthState state = HealthState::kInitializing;                  ///< at the end
  std::array<CalibrationReport, kCalibrationCount> calibration{};  ///< at the end
  bool healthy = true;  ///< never degraded after the start, no calibration doubtful at the end
};

/// @throws std::runtime_error if the options are invalid
Replay replay(const io::Dataset& data, const Options& options);

eval::Trajectory poses_of(const Replay& replay);

/// NaN if unknown.
struct RealScore {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  bool started = false;          ///< before the last motion
  double distance = kUnknown;    ///< of the reference, else of the estimate [m]
  double closure = kUnknown;     ///< distance of first and last position [m]
  double horizontal = kUnknown;  ///< RMS of the distance to the reference, aligned in position and
                                 ///< heading at the first scan [m]
  double height = kUnknown;      ///< RMS against the flat floor or the barometer [m]
  double honest = kUnknown;      ///< share of the scans whose height error is within three sigmas
  double sigmas_median = kUnknown;  ///< height error over its sigma in the second half
  double sigmas_worst = kUnknown;   ///< same
  double farthest = kUnknown;       ///< largest distance from the first position [m]
  bool healthy = false;             ///< see Replay
  double creep = kUnknown;          ///< range of the height during the rest at the end [m]
  double creep_sigmas = kUnknown;   ///< same, in its sigmas at the end
  double pitch = kUnknown;          ///< of the mounting at the end, estimate minus given [rad]
  double pitch_sigma = kUnknown;    ///< [rad]

  double horizontal_share() const { return 100.0 * horizontal / distance; }  ///< [%]
  double height_share() const { return 100.0 * height / distance; }          ///< [%]
  double dishonest_share() const { return 100.0 * (1.0 - honest); }          ///< of the scans [%]
};

RealScore judge(const Recording& recording, const Replay& replay);

/// A recording with one estimator, a score for each seed of the RANSAC.
struct RealRun {
  const Recording* recording;
  std::size_t variant;  ///< index
  std::vector<RealScore> scores{};
};

/// Every recording with every variant and that many seeds. Runs come by recording, then by variant.
std::vector<RealRun> replay_campaign(const std::vector<Recording>& recordings,
                                     const Variants& variants, int seeds, const Settings& settings);

}  // namespace rio::experiment

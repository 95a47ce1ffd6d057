// SPDX-License-Identifier: BSD-3-Clause
// Real recordings without exact truth: found in a folder, perturbed, replayed as a flight stack
// would feed them, and held against what is known of them: a reference path, a flat floor or a
// barometer, the return to the start, the rest at the end.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rio/eval/stamped_pose.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio::experiment {

/// A recording and what is known of its path.
struct Recording {
  std::string name;
  io::Dataset data;
  eval::Trajectory reference;  ///< of reference.tum, may be empty; its heights are true if all zero

  bool flat() const;
};

/// Every folder below `folder` that holds imu0 and radar0, by name.
/// @throws std::runtime_error if there is none or one cannot be read
std::vector<Recording> find_recordings(const std::filesystem::path& folder);

/// A smaller Doppler is none: half a cell and the noise [m/s].
inline double still_bound(double grid) {
  return 0.5 * grid + 0.03;
}

/// First and last instant of motion, by the radar; people near it do not count.
struct Motion {
  Time begin;
  Time end;
};
Motion motion_of(const io::Dataset& data);
/// A scan shows motion that is faster than its grid: it began earlier by up to this.
inline constexpr Time kBeforeMotion = std::chrono::milliseconds(300);

/// A recording with a fault that should not matter.
struct Copy {
  std::string kind;
  Recording recording;
};

/// Copies with two seconds of the rest before the start, every other scan, 30 % of the points
/// dropped, the mounting told wrong by 3 deg, and stamps wrong by 20 ms.
/// @param draws of the random ones
std::vector<Copy> perturbed(const Recording& recording, int draws, std::uint64_t seed);

/// The estimate at one scan.
struct RecordedStep {
  NavState state;
  double sigma_height = 0.0;  ///< [m]
};

/// A replay with static start.
struct Replay {
  std::vector<RecordedStep> steps;  ///< empty if it did not start
  Pose T_BS;                        ///< as estimated at the end
  double time_offset = 0.0;         ///< same, beyond what was told [s]
  int velocity_resets = 0;
};

/// @throws std::runtime_error if the options are invalid
Replay replay(const io::Dataset& data, const Options& options);

/// NaN where nothing is known.
struct RealScore {
  bool started = false;       ///< before the last motion
  double distance = 0.0;      ///< of the reference, else of the estimate [m]
  double closure = 0.0;       ///< distance of first and last position [m]
  double horizontal = 0.0;    ///< RMS of the distance to the reference, start and heading laid over
                              ///< each other at the first scan [m]
  double height = 0.0;        ///< RMS against the flat floor or the barometer [m]
  double honest = 0.0;        ///< share of the scans whose height error is within three sigmas
  double creep = 0.0;         ///< range of the height during the rest at the end [m]
  double creep_sigmas = 0.0;  ///< same, in its sigmas at the end
  Vector3d end = Vector3d::Zero();  ///< in the axes of the reference, where there is one [m]
};

RealScore judge(const Recording& recording, const Replay& replay);

}  // namespace rio::experiment

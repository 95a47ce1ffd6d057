// SPDX-License-Identifier: BSD-3-Clause
// Trajectory files (TUM, EuRoC ground truth) and the states file of a replay.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "rio/eval/stamped_pose.hpp"
#include "rio/io/text_file.hpp"
#include "rio/types.hpp"

namespace rio::io {

using eval::StampedPose;
using eval::Trajectory;

/// Decimal seconds with nine decimals, exact.
std::string seconds_text(Time time);

/// One TUM line without newline: `t x y z qx qy qz qw`, nine decimals each.
std::string tum_line(const StampedPose& pose);

void write_tum(const std::filesystem::path& path, const Trajectory& trajectory);

/// What to do with the lines of a TUM file that are not in the order of time.
enum class TumOrder : std::uint8_t {
  kStrict,  ///< an error
  kSorted,  ///< sort; of equal stamps the first is kept
};

/// Whether a trajectory may be positions alone, as of a total station or GNSS.
enum class Attitude : std::uint8_t {
  kRequired,
  kOptional,  ///< NaN if the file has none
};

/// A dataset folder (its ground truth), a table with commas and stamps in ns (EuRoC ground truth,
/// or a states file), or else a TUM file of exactly eight columns, with blanks or commas between
/// them; of seven if timestamps.txt is beside it (ColoRadar, or its folder); of four (t x y z) if
/// the attitude is optional. An integer stamp of 15 digits or more is in nanoseconds. Throws
/// std::runtime_error "FILE:LINE: ..." if it is damaged, empty, not finite, or if stamps do not
/// strictly increase.
Trajectory read_trajectory(const std::filesystem::path& path, TumOrder order = TumOrder::kStrict,
                           Attitude attitude = Attitude::kRequired);

/// Error of the states file: [dp, dtheta, dv] in W, B, W axes.
using StateCovariance = Eigen::Matrix<double, 9, 9, Eigen::DontAlign>;

/// The part of the body covariance in the states file, in its order.
StateCovariance state_covariance(const BodyCovariance& covariance);

/// One row per estimate: t_ns, p, q wxyz, v, the upper triangle of state_covariance() row by row,
/// gyro bias, accel bias; full precision.
class StatesFile {
 public:
  explicit StatesFile(const std::filesystem::path& path);
  void add(const NavState& state, const BodyCovariance& covariance);
  void close() { file_.close(); }

 private:
  TextFile file_;
};

/// What a run writes, each if its name is not empty: poses in TUM format, and a StatesFile. Of
/// estimates at one instant, as of scans of several radars, the last one is written.
class PathFiles {
 public:
  PathFiles(const std::string& tum, const std::string& states);
  void add(const NavState& state, const BodyCovariance& covariance);
  void close();

 private:
  void write();

  std::optional<TextFile> tum_;
  std::optional<StatesFile> states_;
  std::optional<std::pair<NavState, BodyCovariance>> newest_;  ///< not written yet
};

}  // namespace rio::io

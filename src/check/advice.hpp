// SPDX-License-Identifier: BSD-3-Clause
// The wording of proposed changes: options of the command line for a bag, edits of the files of a
// folder.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "check/finding.hpp"
#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::check {

struct Advice {
  Source source = Source::kFolder;
  const io::RadarInfo* info = nullptr;  ///< of the radar; how its points were read
  std::size_t radar = 0;                ///< its number
  bool several = false;                 ///< it is not the only one

  bool bag() const { return source == Source::kBag; }
  /// Multiplies a quantity of the points: "--field snr=intensity*0.1".
  /// @param from the quantity whose field it is; empty: the same
  std::string scale(const std::string& quantity, double factor, const std::string& from = {}) const;
  /// The other sign of the Doppler.
  std::string negate_doppler() const;
  /// @param factor of the unit in [rad/s]
  std::string gyro_in(const std::string& unit, double factor) const;
  /// "radar1/data.csv"
  std::string csv() const;
  /// A line of the sensor file of this radar.
  std::string sensor_line(const std::string& line) const;
  /// An option "radar: {...}" for the first radar, else a line of the sensor file.
  std::string option(const std::string& of_first, const std::string& of_others) const;
  /// "--axes flu", if points that must be turned by this are in other known axes. As a mounting of
  /// /tf_static is turned with them, it goes with a mounting from elsewhere, of each radar.
  std::optional<std::string> axes(const Matrix3d& turn) const;
  /// Whether the points are read from this quantity.
  bool has(const std::string& quantity) const;
  /// "--field y=y*-1", "--field y=z*1 --field z=y*1", or of an angle, if that makes good points
  /// that are mirrored by M.
  std::optional<std::string> mirror(const Matrix3d& M) const;
  /// "frd", if an IMU in these axes makes the radar appear turned by this about axes of the body,
  /// and its gravity shows them.
  /// @param up specific force at rest, as recorded
  std::optional<std::string> imu_axes(const Matrix3d& turn, const Vector3d& up) const;
};

}  // namespace rio::check

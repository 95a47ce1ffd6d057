// SPDX-License-Identifier: BSD-3-Clause
// The parameters of the calibration as people read them.
#pragma once

#include <array>

#include "rio/report.hpp"

namespace rio::tools {

/// Order of Calibration, with the unit people read.
struct CalibrationName {
  const char* name;
  const char* unit;
  double scale;
  const char* check;  ///< what may be wrong when it is doubtful
};

inline constexpr const char* kMounting = "T_BS in radar0/sensor.yaml";
inline constexpr double kDegrees = 57.29577951308232;
inline constexpr std::array<CalibrationName, kCalibrationCount> kCalibrationNames = {
    {{"radar_rotation_x", "deg", kDegrees, kMounting},
     {"radar_rotation_y", "deg", kDegrees, kMounting},
     {"radar_rotation_z", "deg", kDegrees, kMounting},
     {"radar_position_x", "cm", 100.0, kMounting},
     {"radar_position_y", "cm", 100.0, kMounting},
     {"radar_position_z", "cm", 100.0, kMounting},
     {"doppler_scale", "%", 100.0, "the unit and the grid of the Doppler"},
     {"elevation_bias", "deg", kDegrees, "the elevation of the points, the tilt in T_BS"},
     {"time_offset", "ms", 1000.0, "the stamps of the scans: the middle of the chirps?"}}};

}  // namespace rio::tools

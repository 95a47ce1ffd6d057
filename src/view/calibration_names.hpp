// SPDX-License-Identifier: BSD-3-Clause
// The parameters of the calibration, for display.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <string>

#include "rio/eval/metrics.hpp"
#include "rio/report.hpp"

namespace rio::view {

/// Order of Calibration, with the display unit.
struct CalibrationName {
  const char* name;
  const char* unit;
  double scale;  ///< from SI
  const char* si_unit;
  const char* check;  ///< possible cause when it is doubtful
};

inline constexpr const char* kMounting = "T_BS of radar0";
inline constexpr std::array<CalibrationName, kCalibrationCount> kCalibrationNames = {
    {{"radar_rotation_x", "deg", eval::kDegreesPerRadian, "rad", kMounting},
     {"radar_rotation_y", "deg", eval::kDegreesPerRadian, "rad", kMounting},
     {"radar_rotation_z", "deg", eval::kDegreesPerRadian, "rad", kMounting},
     {"radar_position_x", "cm", 100.0, "m", kMounting},
     {"radar_position_y", "cm", 100.0, "m", kMounting},
     {"radar_position_z", "cm", 100.0, "m", kMounting},
     {"doppler_scale", "%", 100.0, "1", "the unit and the grid of the Doppler"},
     {"time_offset", "ms", 1000.0, "s", "the stamps of the scans: the middle of the chirps?"}}};

/// Of radar r: "radar_rotation_x" is "radar1_rotation_x", "time_offset" is "radar1_time_offset".
inline std::string calibration_name(std::size_t i, std::size_t r) {
  std::string name = kCalibrationNames[i].name;
  if (r == 0) return name;
  const std::string own = "radar" + std::to_string(r) + "_";
  return own + (name.rfind("radar_", 0) == 0 ? name.substr(6) : name);
}
/// A name of the program as the beginning of a title: "radar1_time_offset" is "Radar1 time offset".
inline std::string title_of(std::string name) {
  name[0] = static_cast<char>(std::toupper(name[0]));
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}
/// Possible cause for radar r.
inline std::string calibration_check(std::size_t i, std::size_t r) {
  std::string check = kCalibrationNames[i].check;
  const std::size_t at = check.find("radar0");
  if (at != std::string::npos) check.replace(at, 6, "radar" + std::to_string(r));
  return check;
}

}  // namespace rio::view

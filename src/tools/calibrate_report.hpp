// SPDX-License-Identifier: BSD-3-Clause
// What `rio calibrate` prints: a row a parameter, as a table or as JSON.
#pragma once

#include <string>
#include <vector>

#include "calibrate/noise_over_recordings.hpp"
#include "calibrate/radar_calibration.hpp"
#include "rio/options.hpp"

namespace rio::tools {

/// What has been found of which recordings.
struct CalibrateReport {
  std::vector<std::string> datasets;
  Options told;
  calibrate::RadarCalibration radar;
  calibrate::SensorNoise noise;
  std::vector<std::string> notes;
  std::vector<std::string> written;  ///< files

  std::string text() const;
  /// One line.
  std::string json() const;
};

}  // namespace rio::tools

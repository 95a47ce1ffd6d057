// SPDX-License-Identifier: BSD-3-Clause
// What `rio calibrate` prints: a row a parameter, as a table or as JSON.
#pragma once

#include <string>
#include <vector>

#include "calibrate/noise_over_recordings.hpp"
#include "calibrate/radar_calibration.hpp"
#include "rio/options.hpp"

namespace rio::tools {

/// The noise of an IMU at rest is the least it has: a smaller one than configured is no reason to
/// believe the IMU more in motion.
inline bool exceeds_configured(const calibrate::NoiseEstimate& noise, double configured) {
  return noise.verdict == calibrate::Determination::kDetermined && noise.value > configured;
}

/// What has been found of which recordings.
struct CalibrateReport {
  std::vector<std::string> datasets;
  Options configured;
  calibrate::RadarCalibration radar;
  calibrate::SensorNoise noise;
  std::vector<std::string> notes;
  std::vector<std::string> written;  ///< files

  std::string text() const;
  /// One line.
  std::string json() const;
};

}  // namespace rio::tools

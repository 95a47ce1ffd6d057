// SPDX-License-Identifier: BSD-3-Clause
// Output of `rio calibrate`: a row per parameter, as a table or as JSON.
#pragma once

#include <string>
#include <vector>

#include "calibrate/noise_over_recordings.hpp"
#include "calibrate/radar_calibration.hpp"
#include "rio/options.hpp"

namespace rio::tools {

/// The noise of an IMU at rest is a lower bound: a smaller value than configured is no reason to
/// give the IMU more weight in motion.
inline bool exceeds_configured(const calibrate::NoiseEstimate& noise, double configured) {
  return noise.verdict == calibrate::Determination::kDetermined && noise.value > configured;
}

/// Results, with their recordings.
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

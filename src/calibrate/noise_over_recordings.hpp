// SPDX-License-Identifier: BSD-3-Clause
// The noise of radar and IMU over several recordings, and over their halves as a check. The radar
// noise is from calibrate_noise(); that of the IMU is measured at rest:
// (E1) density^2 = T AVAR(T), AVAR(T) = mean of (y_k+1 - y_k)^2 / 2 over the means y of segments of
//      length T: the Allan variance of white noise; vibration much faster than 1 / T is averaged
//      out. (IEEE Std 952-1997, annex C)
// (E2) relative error 1 / sqrt(4 n / 3), n differences of three axes: neighbours share a segment
// (E3) over recordings: weighted mean of the logarithms, its error widened by the spread (Birge)
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/radar_calibration.hpp"

namespace rio::calibrate {

/// A sigma or a density in SI units.
struct NoiseEstimate {
  double value = 0.0;
  double relative_error = 0.0;  ///< one sigma, over the value; infinite if undetermined
  double halves_apart = 0.0;    ///< in sigmas, the worst recording; NaN if not compared
  Determination verdict = Determination::kNotDetermined;
};

struct SensorNoise {
  /// Range, azimuth, elevation, Doppler: order of eval::RadarNoise. Not determined: hidden by its
  /// grid, too few matches, not converged, or relative error above 20 %.
  std::array<NoiseEstimate, 4> radar{};
  std::optional<double> weak_snr_db;  ///< used in the fit of the radar sigmas
  NoiseEstimate gyro;                 ///< density [rad/s/sqrt(Hz)]
  NoiseEstimate accel;                ///< same [m/s^2/sqrt(Hz)]
  std::vector<std::string> notes;     ///< recordings without information, and why
};

/// @param runs of the recordings, for the start of motion and the halves
/// @param options with the calibrated radar
SensorNoise noise_over_recordings(const std::vector<Recording>& recordings,
                                  const std::vector<RecordingCalibration>& runs,
                                  const Options& options,
                                  const std::function<void(const std::string&)>& each = {});

}  // namespace rio::calibrate

// SPDX-License-Identifier: BSD-3-Clause
// Properties of the data of a recording, without an estimator: rates, losses, vibration and its
// spectrum, points, grids. For comparison with its simulated twin.
//
// (E1) an interpolated sample lies on the line between its neighbours, on all six axes
// (E2) power of a band: sum of 2 |X_k|^2 / (n sum w^2) over its lines, X the transform of 0.64 s
//      times a Hann window w, mean and trend removed; averaged over windows that overlap by half
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "experiment/recording.hpp"
#include "rio/io/dataset.hpp"
#include "rio/types.hpp"

namespace rio::experiment {

/// 10 %, 50 % and 90 % quantile; NaN without values.
struct Quantiles {
  double low = 0.0;
  double median = 0.0;
  double high = 0.0;

  static Quantiles of(std::vector<double> values);
};

/// Lower edges of the bands of a spectrum; the last goes up to the Nyquist frequency [Hz].
inline constexpr std::array<double, 5> kBandEdges = {1.0, 5.0, 10.0, 20.0, 35.0};
/// RMS per axis in each band; NaN if there is less than one window.
using Bands = std::array<double, kBandEdges.size()>;

/// RMS over the bands from `first` to the last.
double rms_from(const Bands& bands, std::size_t first);

/// (E2) of samples with assumed even spacing. @param rate_hz of the samples
Bands spectrum(const std::vector<Vector3d>& samples, double rate_hz);

/// Of the IMU; units rad/s and m/s^2.
struct ImuSignature {
  double rate_hz = 0.0;       ///< by the median interval
  double missing = 0.0;       ///< share of missing samples at that rate
  double interpolated = 0.0;  ///< share of interpolated among the present samples (E1)
  double run = 0.0;           ///< mean number of consecutive lost samples, of either kind
  Bands gyro_rest{};          ///< before the first motion
  Bands gyro_moving{};
  Bands accel_rest{};
  Bands accel_moving{};
  double unsteadiness = 0.0;  ///< 90 % over 10 % quantile of the accelerometer's rms in 0.64 s
  double kurtosis = 0.0;      ///< of its changes from sample to sample in motion; 3 = Gaussian
};
ImuSignature imu_signature(const io::Dataset& data, const Motion& motion);

/// Of the radar. "Still" is a Doppler within half a cell.
struct RadarSignature {
  double rate_hz = 0.0;           ///< by the median interval
  double late = 0.0;              ///< share of the intervals beyond 1.5 of the median one
  Quantiles points;               ///< a scan
  double mean_points = 0.0;       ///< same
  double empty = 0.0;             ///< share of the scans
  double doppler_grid = 0.0;      ///< 0 = none [m/s]
  Quantiles speed;                ///< |Doppler| in motion [m/s]
  Quantiles range;                ///< [m]
  Quantiles azimuth;              ///< [rad]
  Quantiles elevation;            ///< [rad]
  Quantiles snr_db;               ///< [dB]
  double snr_floor_db = 0.0;      ///< its 1 % quantile [dB]
  double snr_range = 0.0;         ///< slope of the SNR over the logarithm of range [dB per decade]
  double still_at_rest = 0.0;     ///< share of the points of the rest before the start
  double repeated_at_rest = 0.0;  ///< share found again within 0.1 m in the next scan
  double repeated_moving = 0.0;   ///< same in motion, within 0.1 m more than the distance travelled
  /// Share of the points in motion that have no Doppler and are found again within 0.1 m after half
  /// a second: echoes of the vehicle itself, or of objects that move along.
  double rides_along = 0.0;
};
RadarSignature radar_signature(const io::Dataset& data, const Motion& motion);

}  // namespace rio::experiment

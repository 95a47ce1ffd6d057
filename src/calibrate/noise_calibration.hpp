// SPDX-License-Identifier: BSD-3-Clause
// The noise of a radar from a recording: run, fit the sigmas to the innovations, and repeat with
// these, since the predicted covariance and the accepted measurements depend on them.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "rio/eval/noise_fit.hpp"
#include "rio/options.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/types.hpp"

namespace rio::calibrate {

/// RadarOptions::weak_snr_db if the noise of all echoes is alike [dB].
inline constexpr double kAllAlike = -200.0;

/// The true state at a time, if known.
using TruthAt = std::function<std::optional<NavState>(Time)>;

/// Start of a run.
using Start = Alignment;

/// Input of a run.
struct Recording {
  std::vector<ImuSample> imu;
  std::vector<RadarScan> scans;
  std::optional<Start> start;  ///< if missing, static alignment
  TruthAt truth;               ///< may be empty
};

/// The interpolated truth of a recording, none outside of its rows or in gaps longer than 0.1 s.
/// Empty if no row has a velocity. `rows` by increasing stamp.
TruthAt interpolated_truth(std::vector<NavState> rows);

/// A fit with its history.
struct NoiseCalibration {
  eval::NoiseFit fit;
  int runs = 0;
  bool converged = false;  ///< the last run changed no sigma by more than 2 % or its standard error
  std::array<bool, 4> settled{};  ///< it changed the sigma by less than a standard error
  std::size_t landmarks = 0;      ///< matches with landmarks in the last run
  std::size_t dopplers = 0;
};

/// Fits radar.sigma_* and, unless it is switched off, radar.weak_snr_db. The runs match and gate
/// more widely than `options`.
/// @param each called after every run, for progress
/// @throws std::runtime_error if the options are invalid, the run does not start, or there are too
/// few matches
NoiseCalibration calibrate_noise(const Recording& recording, const Options& options,
                                 const std::function<void(const NoiseCalibration&)>& each = {});

/// The options with the fitted noise; growth that is not observed is switched off.
Options with_noise(Options options, const eval::NoiseFit& fit);

}  // namespace rio::calibrate

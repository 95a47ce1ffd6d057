// SPDX-License-Identifier: BSD-3-Clause
// The noise of a radar from a recording: run, fit the sigmas to the innovations, run again with
// them, because the covariance the filter predicts and what it accepts depend on them.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "calibrate/innovations.hpp"
#include "rio/eval/noise_fit.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::calibrate {

/// Where a run begins.
struct Start {
  NavState state;
  BodyCovariance covariance = BodyCovariance::Zero();
};

/// What is run.
struct Recording {
  std::vector<ImuSample> imu;
  std::vector<RadarScan> scans;
  std::optional<Start> start;  ///< without one the run aligns itself at rest
  TruthAt truth;               ///< may be empty
};

/// The truth of a recording between its rows, nothing outside them or in gaps longer than 0.1 s.
/// Empty if no row has a velocity. `rows` by increasing stamp.
TruthAt interpolated_truth(std::vector<NavState> rows);

/// One run with these options.
/// @throws std::runtime_error if the options are invalid or the run does not start
Innovations observe_innovations(const Recording& recording, const Options& options);

/// A fit and how it came about.
struct NoiseCalibration {
  eval::NoiseFit fit;
  int runs = 0;
  bool converged = false;     ///< the last run changed no sigma by 2 % and a standard error
  std::size_t landmarks = 0;  ///< matches with landmarks in the last run
  std::size_t dopplers = 0;
};

/// Fits radar.sigma_* and, if radar.weak_snr_db is not switched off, that. The runs match and gate
/// more widely than `options` say.
/// @param each called after every run, for progress
/// @throws std::runtime_error as observe_innovations(), and if there are too few matches
NoiseCalibration calibrate_noise(const Recording& recording, const Options& options,
                                 const std::function<void(const NoiseCalibration&)>& each = {});

/// The options with the fitted noise; growth that is not seen is switched off.
Options with_noise(Options options, const eval::NoiseFit& fit);

}  // namespace rio::calibrate

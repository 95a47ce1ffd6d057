// SPDX-License-Identifier: BSD-3-Clause
// One run of one estimator without an end in sight: its figures by rows, and a hash of all its
// estimates to compare runs.
#pragma once

#include <cstdint>
#include <vector>

#include "rio/options.hpp"
#include "rio/report.hpp"

namespace rio::experiment {

/// Order in which samples and scans are given. The estimates do not depend on it.
enum class Interleaving {
  kScanFirst,  ///< each scan at its time, before the next sample
  kImuFirst,   ///< each scan after the first sample newer than it
  kEarly,      ///< two tenths of a second ahead of the samples: scans wait
  kLate,       ///< a tenth of a second behind them
};

struct SoakSettings {
  double seconds = 60.0;
  double every = 20.0;  ///< period of the rows [s]
  BackEnd backend = BackEnd::kEkf;
  Interleaving interleaving = Interleaving::kScanFirst;
  std::uint64_t seed = 1;
};

/// At the last scan of a row; "largest" and "mean" are over its scans.
struct SoakRow {
  double resident = 0.0;                       ///< memory of the process [MB]
  Vector3d position_error = Vector3d::Zero();  ///< world axes [m]
  double position_sigma = 0.0;                 ///< root of the trace of its covariance [m]
  double nees_velocity = 0.0;                  ///< over its dimension, mean; body axes
  double nees_tilt = 0.0;                      ///< same
  double calibration = 0.0;                    ///< mean (error / sigma)^2 of its parameters
  double asymmetry = 0.0;                      ///< largest of P
  double norm_error = 0.0;                     ///< largest of | |q| - 1 |
  double lag = 0.0;                            ///< largest of now() to the newest sample [s]
};

struct SoakRun {
  std::vector<SoakRow> rows;
  std::uint64_t scans = 0;                     ///< given
  std::uint64_t hash = 0xcbf29ce484222325ULL;  ///< of state and covariance at every scan
  bool finite = true;                          ///< all of them
  Counters counters;
};

/// Flies the default preset from a known start.
SoakRun run_soak(const SoakSettings& settings);

}  // namespace rio::experiment

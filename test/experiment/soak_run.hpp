// SPDX-License-Identifier: BSD-3-Clause
// One long run of one estimator: its figures every few minutes, and a hash of all its estimates to
// compare runs.
#pragma once

#include <cstdint>
#include <functional>
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
  double seconds = 86'400.0;
  double every = 600.0;  ///< period of the rows [s]
  BackEnd backend = BackEnd::kEkf;
  Interleaving interleaving = Interleaving::kScanFirst;
  std::uint64_t seed = 1;
};

/// At the last scan of a row; "largest" and "mean" are over its scans.
struct SoakRow {
  double time = 0.0;                           ///< of flight [s]
  double resident = 0.0;                       ///< memory of the process [MB]
  Vector3d position_error = Vector3d::Zero();  ///< world axes [m]
  double position_sigma = 0.0;                 ///< root of the trace of its covariance [m]
  double velocity_error = 0.0;                 ///< [m/s]
  double tilt_error = 0.0;                     ///< [rad]
  double nees_position = 0.0;                  ///< here and below, over its dimension
  double nees_velocity = 0.0;                  ///< mean
  double nees_tilt = 0.0;                      ///< mean
  double calibration = 0.0;                    ///< mean (error / sigma)^2 of its parameters
  double asymmetry = 0.0;                      ///< largest of P
  double norm_error = 0.0;                     ///< largest of | |q| - 1 |
  double lag = 0.0;                            ///< largest of now() to the newest sample [s]
  double time_per_scan = 0.0;                  ///< mean [s]
  double longest_scan = 0.0;                   ///< [s]
};

struct SoakRun {
  std::vector<SoakRow> rows;
  std::uint64_t scans = 0;                     ///< given
  std::uint64_t hash = 0xcbf29ce484222325ULL;  ///< of state and covariance at every scan
  bool finite = true;                          ///< all of them
  Counters counters;
};

/// Flies the default preset from a known start. Calls back with each row when it ends.
SoakRun run_soak(const SoakSettings& settings,
                 const std::function<void(const SoakRow&)>& each = {});

}  // namespace rio::experiment

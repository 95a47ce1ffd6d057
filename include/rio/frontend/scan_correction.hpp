// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: a scan as the estimator uses it: corrected for the estimated errors of its radar,
// without the echoes of the vehicle itself.
#pragma once

#include <vector>

#include "rio/frontend/direction_noise.hpp"
#include "rio/frontend/own_echoes.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// No allocation after construction.
class ScanCorrection {
 public:
  explicit ScanCorrection(const Options& options);

  /// The radar may have been moved, or the velocity was wrong.
  void reset() {
    for (OwnEchoes& own : own_echoes_) own.reset();
  }

  /// The corrected scan; valid until the next call.
  /// @param x predicted to the scan
  /// @param velocity_covariance of the predicted radar velocity, radar axes [m^2/s^2]
  const DetectionList& correct(const DetectionList& received, const Estimate& x,
                               const Matrix3d& velocity_covariance);

  /// Takes the static set of the corrected scan.
  void observe(const Observations& seen, const Estimate& x);

  /// Own echoes in the last scan.
  const OwnEchoList& own_echoes() const { return own_; }

  /// Makes the records of the corrected scan refer to the detections of the received one.
  void restore_indices(UpdateReport* report) const;

 private:
  bool use_own_echoes_;
  bool use_direction_noise_;
  std::vector<OwnEchoes> own_echoes_;  ///< by radar
  std::vector<DirectionNoise> noise_;  ///< same
  OwnEchoList own_;
  DetectionList corrected_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: tells when the estimate's velocity is wrong and its covariance denies it. The gates then
// refuse the very measurements that could correct it, for ever.
//
// v, Sigma: the radar's velocity by the consensus of the scan; v', P: as predicted
// (E1) |d + u . v'|, modulo 2 v_max, < hypot(bound_i, 3 sqrt(u^T P u)): the prediction explains a
//      detection. The bound is that of the static set of v: with one of its own, a prediction would
//      explain the more the faster it is.
// (E2) (v - v')^T (Sigma + P)^-1 (v - v') above the far quantile of chi^2(3): the two velocities
//      differ
// A scan contradicts if its consensus is many detections and most of the scan, the prediction
// explains less than half as many, and (E2). A crowd, a burst of outliers or a chance agreement of
// few points is no majority. The verdict takes kScans contradictions in a row; any other scan ends
// the row. (E2) alone would not do: the consensus of one scan is off by several of its sigmas when
// outliers slip into it, but then the prediction still explains the static detections.
#pragma once

#include "rio/core/chi2.hpp"
#include "rio/frontend/ego_velocity.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"

namespace rio {

class VelocityMonitor {
 public:
  /// Contradictions in a row that make a verdict. One scan can be led astray by whatever passes
  /// close by; three are 0.2 s at 15 Hz, in which a velocity error of 3 m/s displaces by 0.6 m.
  static constexpr int kScans = 3;

  explicit VelocityMonitor(const Options& options);

  /// Starts over; the velocity counts as right at `time`.
  void reset(Time time);

  /// The verdict after one more scan.
  bool contradicts(const Observations& seen, const RadarVelocity& predicted);

  /// The last scan, or reset, that did not contradict.
  Time agreed() const { return agreed_; }

 private:
  /// Twice the inliers of a consensus, and more than half of the detections.
  bool is_majority(const Observations& seen) const;
  bool explains(const RadarVelocity& predicted, const Observations& seen) const;
  bool differs(const EgoVelocity& scan, const RadarVelocity& predicted) const;

  /// One false (E2) in a year of scans at 15 Hz, were the errors Gaussian.
  static constexpr double kAgreement = 1.0 - 2e-9;

  FrontendOptions options_;
  DopplerFold fold_;
  double far_;
  int row_ = 0;
  Time agreed_{0};
};

}  // namespace rio

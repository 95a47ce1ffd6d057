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

#include <Eigen/Cholesky>
#include <cmath>

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

  explicit VelocityMonitor(const Options& options)
      : options_(options.frontend),
        fold_(options.frontend.unwrap_doppler ? options.radar.max_doppler : 0.0),
        far_(chi2_quantile(kAgreement, 3.0)) {}

  /// Starts over; the velocity counts as right at `time`.
  void reset(Time time) {
    row_ = 0;
    agreed_ = time;
  }

  /// The verdict after one more scan.
  bool contradicts(const Observations& seen, const RadarVelocity& predicted) {
    if (!options_.velocity_recovery) return false;
    const bool against =
        is_majority(seen) && !explains(predicted, seen) && differs(seen.ego_velocity, predicted);
    if (!against) reset(seen.scan->time);
    return against && ++row_ >= kScans;
  }

  /// The last scan, or reset, that did not contradict.
  Time agreed() const { return agreed_; }

 private:
  /// Twice the inliers of a consensus, and more than half of the detections.
  bool is_majority(const Observations& seen) const {
    const EgoVelocity& scan = seen.ego_velocity;
    return scan.valid && scan.covariance && scan.inliers >= 2 * options_.ransac_min_inliers &&
           2 * scan.inliers > static_cast<int>(seen.scan->items.size());
  }
  bool explains(const RadarVelocity& predicted, const Observations& seen) const {
    constexpr double kSigmas = 3.0;
    int explained = 0;
    for (const Detection& d : seen.scan->items) {
      const Vector3d& u = d.direction_S;
      const double bound = static_bound(options_, residual_variance(d, seen.ego_velocity.v_S));
      const double spread = kSigmas * std::sqrt(u.dot(predicted.covariance * u));
      const double residual = fold_.wrap(d.range_rate + u.dot(predicted.v_S));
      explained += std::abs(residual) < std::hypot(bound, spread) ? 1 : 0;  // (E1)
    }
    return 2 * explained >= seen.ego_velocity.inliers;
  }
  bool differs(const EgoVelocity& scan, const RadarVelocity& predicted) const {  // (E2)
    const Vector3d difference = scan.v_S - predicted.v_S;
    const Eigen::LLT<Matrix3d> llt(*scan.covariance + predicted.covariance);
    return llt.info() == Eigen::Success && difference.dot(llt.solve(difference)) > far_;
  }

  /// One false (E2) in a year of scans at 15 Hz, were the errors Gaussian.
  static constexpr double kAgreement = 1.0 - 2e-9;

  FrontendOptions options_;
  DopplerFold fold_;
  double far_;
  int row_ = 0;
  Time agreed_{0};
};

}  // namespace rio

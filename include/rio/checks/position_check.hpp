// SPDX-License-Identifier: BSD-3-Clause
// Check of the position: its possible error after an interval in which the measurements
// contradicted the estimate without replacing anything: a crowd or a lorry may have filled the view
// for seconds and have dragged the velocity, or may only have tried to.
//
// (E1) possible error of the velocity, the sum of
//      - the difference to the other velocity (checks/velocity_check.hpp) while that
//        contradicts it;
//      - while the gates reject more rows than usual (checks/health_monitor.hpp), the rejected
//        share times the pace of what moves;
//      - while nearly all detections are outliers (same), the sigma of the predicted velocity: the
//        consensus, sought about the prediction, may be one by chance
// (E2) that of the position, when the interval ends: the integral of (E1)
//
// In the interval itself the health is degraded; after it only the covariance can tell.
#pragma once

#include "rio/core/motion.hpp"

namespace rio {

/// What casts doubt on an update; zeros if nothing does.
struct Doubt {
  double contradiction = 0.0;  ///< difference to the other velocity [m/s]
  double gated = 0.0;          ///< share of the rows
  double sigma = 0.0;          ///< of the predicted velocity, if nearly all are outliers [m/s]
};

class PositionCheck {
 public:
  /// The velocity was replaced; that accounts for the interval.
  void reset() { distance_ = 0.0; }

  /// Takes an update.
  /// @param seconds since the update before
  /// @return (E2) if an interval has ended and left a noticeable one, otherwise 0 [m]
  double observe(const Doubt& doubt, double seconds) {
    const double speed = doubt.contradiction + kPaceOfPeople * doubt.gated + doubt.sigma;  // (E1)
    distance_ += speed * seconds;
    if (speed > 0.0) return 0.0;
    const double distance = distance_;
    distance_ = 0.0;
    return distance > kNoticeable ? distance : 0.0;
  }

 private:
  static constexpr double kNoticeable = 0.3;  // landmarks are further apart and correct less [m]

  double distance_ = 0.0;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: detects echoes of the vehicle that carries the radar: a bumper, a wheel, a landing gear.
// They have no Doppler, whatever the vehicle does; where points are few and Dopplers coarse they
// look like static points of small radial speed and bias the velocity towards zero.
//
// A point without Doppler at a position in radar axes is either part of the vehicle or a static
// point that happens to be there. With its range rate d, of standard deviation sigma, and the rate
// h predicted for a static point there, of variance S, direction error included:
// (E1) log-likelihood ratio of the two: (wrap(d - h)^2 / S - d^2 / sigma^2 + ln(S / sigma^2)) / 2,
//      counted where h exceeds its own sigma, in scans whose points with a Doppler agree with the
//      prediction: with a wrong velocity every static point would look like part of the vehicle
// (E2) the evidence of a place is the sum over its sightings, of each at most kMaxOfSighting; from
//      kEvidenceOfEcho on the place is part of the vehicle
#pragma once

#include <cstddef>

#include "rio/core/static_vector.hpp"
#include "rio/frontend/doppler_fold.hpp"
#include "rio/models/detection.hpp"
#include "rio/types.hpp"

namespace rio {

/// Indices of detections, ascending.
using OwnEchoList = StaticVector<std::size_t, kMaxDetections>;

/// No allocation; O(detections * kPlaces) a scan.
class OwnEchoes {
 public:
  /// @param fold of the range rates as the radar reports them
  explicit OwnEchoes(const DopplerFold& fold) : reported_(fold), fold_(fold) {}

  /// Forgets all places: the radar may have been moved, or the velocity was wrong.
  void reset() { places_.clear(); }

  /// Takes a scan and writes the indices of the vehicle's own echoes to `own`, in ascending order.
  /// @param v_S,covariance_S predicted velocity of the radar, its axes [m/s], [m^2/s^2]
  /// @param doppler_scale factor by which the range rates have been divided
  void observe(const DetectionList& scan, const Vector3d& v_S, const Matrix3d& covariance_S,
               OwnEchoList* own, double doppler_scale = 1.0);

 private:
  struct Place {
    Vector3d point_S = Vector3d::Zero();  ///< [m]
    double evidence = 0.0;                ///< (E2)
    Time seen{0};                         ///< last sighting
  };
  /// Predicted range rate of a detection if static [m/s]: mean and variance, with Doppler noise.
  struct Rate {
    double h = 0.0;
    double S = 0.0;
  };
  /// Range rate minus its prediction, modulo the fold [m/s].
  double apart(const Detection& d, const Rate& rate) const {
    return fold_.wrap(d.range_rate - rate.h);
  }
  static Rate predicted(const Detection& d, const Vector3d& v_S, const Matrix3d& covariance_S);
  static bool may_be_zero(const Detection& d) {
    return std::abs(d.range_rate) < kSigmas * d.sigma_doppler;
  }
  /// Some points have a Doppler, and most of these the predicted one.
  bool moves(const DetectionList& scan, const Vector3d& v_S, const Matrix3d& covariance_S) const;
  /// The known place of a detection; null if there is none.
  Place* find(const Detection& d);
  /// Adds a place; if there are too many, it replaces the one unseen for longest.
  Place* add(const Detection& d);

  static constexpr std::size_t kPlaces = 32;
  static constexpr double kReach = 2.0;   // parts of a small vehicle are within [m]
  static constexpr double kSigmas = 3.0;  // of a Doppler that may be zero, or as predicted
  static constexpr int kWitnesses = 2;    // points that confirm the predicted velocity
  static constexpr double kNear = 11.34;  // chi-squared of 3 degrees of freedom, 99 %
  /// Odds of five hundred million to one: an hour of scans makes some million tests.
  static constexpr double kEvidenceOfEcho = 20.0;
  static constexpr double kMaxEvidence = 2.0 * kEvidenceOfEcho;
  static constexpr double kMaxOfSighting = kEvidenceOfEcho / 3.0;
  static constexpr Time kForget = std::chrono::seconds(30);

  DopplerFold reported_;
  DopplerFold fold_;  ///< of the current scan
  StaticVector<Place, kPlaces> places_;
};

}  // namespace rio

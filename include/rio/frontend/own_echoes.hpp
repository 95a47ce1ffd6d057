// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: echoes of the vehicle that carries the radar: a bumper, a wheel, a landing gear. They
// have no Doppler, whatever the vehicle does; where points are few and Dopplers coarse they pass
// for static points whose radial speed is small, and hold the velocity back.
//
// A point without Doppler at a place of the radar's view is either part of the vehicle or a static
// point that happens to be there. With the rate d, of the noise sigma, and the rate h that the
// predicted velocity gives the place, of the variance S, direction error included:
// (E1) log-likelihood ratio of the two: (wrap(d - h)^2 / S - d^2 / sigma^2 + ln(S / sigma^2)) / 2,
//      counted where h is beyond its own sigma, in scans whose points with a Doppler move as
//      predicted: with a wrong velocity all the world seems to be part of the vehicle
// (E2) the evidence of a place is the sum over its sightings, of each at most kOnce; from kSure on
//      it is part of the vehicle
#pragma once

#include <cstddef>

#include "rio/core/static_vector.hpp"
#include "rio/frontend/doppler_fold.hpp"
#include "rio/models/detection.hpp"
#include "rio/types.hpp"

namespace rio {

/// Allocates nothing; the number of operations grows with detections times kPlaces.
class OwnEchoes {
 public:
  /// @param max_doppler range rates fold into +-this; 0 = they do not fold [m/s]
  explicit OwnEchoes(double max_doppler) : fold_(max_doppler) {}

  /// The radar may have been moved, or the velocity was wrong.
  void reset() { places_.clear(); }

  /// Takes note of a scan and puts the indices of the vehicle's own echoes into `own`, rising.
  /// @param v_S,covariance_S predicted velocity of the radar, its axes [m/s]
  void observe(const DetectionList& scan, const Vector3d& v_S, const Matrix3d& covariance_S,
               StaticVector<std::size_t, kMaxDetections>* own);

 private:
  struct Place {
    Vector3d point_S = Vector3d::Zero();  ///< [m]
    double evidence = 0.0;                ///< (E2)
    Time seen{0};                         ///< last
  };
  /// Of the rate the predicted velocity gives a detection: mean and variance, its own noise
  /// included.
  struct Rate {
    double h = 0.0;
    double S = 0.0;
  };
  /// A range rate and what was predicted for it apart, however often it was folded [m/s].
  double apart(const Detection& d, const Rate& rate) const {
    return fold_.wrap(d.range_rate - rate.h);
  }
  static Rate predicted(const Detection& d, const Vector3d& v_S, const Matrix3d& covariance_S);
  static bool may_be_zero(const Detection& d);
  /// Points have a Doppler, and nearly all of these one as predicted.
  bool moves(const DetectionList& scan, const Vector3d& v_S, const Matrix3d& covariance_S) const;
  /// Where a detection was seen before; null if nowhere.
  Place* find(const Detection& d);
  /// In place of the one not seen for longest, if there are too many.
  Place* add(const Detection& d);

  static constexpr std::size_t kPlaces = 32;
  static constexpr double kReach = 2.0;   // parts of a small vehicle are within [m]
  static constexpr double kSigmas = 3.0;  // of a Doppler that may be zero, or as predicted
  static constexpr int kWitnesses = 2;    // that the radar moves as predicted
  static constexpr double kNear = 11.34;  // chi-squared of 3 degrees of freedom, 99 %
  /// Five hundred million to one: an hour of scans asks some million times.
  static constexpr double kSure = 20.0;
  static constexpr double kMost = 2.0 * kSure;
  static constexpr double kOnce = kSure / 3.0;
  static constexpr Time kForget = std::chrono::seconds(30);

  DopplerFold fold_;
  StaticVector<Place, kPlaces> places_;
};

}  // namespace rio

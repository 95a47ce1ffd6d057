// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: noise inflation of the directions of landmarks, by the correlation of their errors,
// measured in flight.
//
// The direction of a static point has an error that lasts: antenna pattern, multipath, the side
// from which a reflector is seen. Over the looks at a landmark, independent innovations cancel in
// their sum, lasting ones add up (data/theory.md, 8):
// (E1) f = E |sum b^k nu_k|^2 / E sum b^2k |nu_k|^2, nu_k the normalised innovations of azimuth and
//      elevation, k looks ago; b gives the memory of the sum, E the mean over looks. Independent:
//      f = 1; a share c of their variance common to n looks: 1 + c (n - 1) at the last of them, on
//      average over them some two thirds of it
// (E2) n looks have as much information as n / f independent ones: the variance is multiplied by f
// The estimate adapts to the landmark, so that f is somewhat too small; as the inflation grows, it
// adapts less. Looks from nearly the same place do not count and are not inflated: there the whole
// error repeats (noise_inflation.hpp). On recordings of karts f is 3 to 11, carried by hand 2.6, in
// simulated flights, whose directions are independent, 1.4 to 2: errors of the estimate last, too.
//
// An elevation error that lasts is no constant: multipath of the floor and the side that is seen
// change as the radar moves. Of a share c of the variance that decays over a length L of the way
// (first-order Gauss-Markov), a walk is left on the scale of two looks; rho is the horizontal
// distance of the landmark, s the way:
// (E3) Var z += rho^2 2 c sigma^2 s / L, c = (f - 2) / (10 - 2) within [0, 1], f of the elevations
//      alone: the estimate's own errors take it to 2 in simulated flights, errors that last
//      entirely to 10
// Reference: Bayley and Hammersley, The "Effective" Number of Independent Observations in an
// Autocorrelated Time Series, 1946 (E2); Law and Kelton, Simulation Modeling and Analysis (sums).
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "rio/state/estimate.hpp"

namespace rio {

/// (E3) Variances that the random walk of a landmark adds along the axes of W [m^2]; none if `walk`
/// is zero.
/// @param walk of every landmark [m/sqrt(m)]
/// @param distance travelled [m]
inline Vector3d landmark_walk(const LandmarkState& landmark, const Vector3d& p_WB, double walk,
                              double distance) {
  if (!(walk > 0.0)) return Vector3d::Zero();
  const double square_distance = (landmark.p_W - p_WB).head<2>().squaredNorm();
  const Vector3d rate(0.0, 0.0, landmark.looks.elevation_walk * square_distance);
  return distance * (Vector3d::Constant(walk * walk) + rate);
}

/// Of the landmarks of one radar.
class LookCorrelation {
 public:
  /// Takes the next look at a landmark.
  /// @param innovation of azimuth and elevation, each divided by its sigma
  /// @param sum of this landmark
  void add(const Eigen::Vector2d& innovation, LandmarkState::Looks* sum) {
    sum->innovation = kKept * sum->innovation + innovation;
    sum->squares = kKept * kKept * sum->squares + innovation.cwiseAbs2();
    sums_ += sum->innovation.cwiseAbs2() - sums_ / kMemory;
    squares_ += sum->squares - squares_ / kMemory;
  }

  /// f of (E2), at least 1.
  double factor() const { return std::max(1.0, sums_.sum() / squares_.sum()); }

  /// Rate of (E3) over rho^2 [rad^2/m].
  /// @param sigma of elevation [rad]
  double elevation_walk(double sigma) const {
    const double f = sums_.y() / squares_.y();
    const double lasting = std::clamp((f - kOwn) / (kFirst - kOwn), 0.0, 1.0);
    return 2.0 * lasting * sigma * sigma / kLength;
  }

 private:
  static constexpr double kKept = 0.98;      ///< b: fifty looks, one to five seconds
  static constexpr double kMemory = 1000.0;  ///< looks: a scene
  static constexpr double kFirst = 10.0;     ///< f before the first look: that of rough recordings
  static constexpr double kOwn = 2.0;        ///< f by errors of the estimate itself
  static constexpr double kLength = 20.0;    ///< L: a room, a street [m]
  static constexpr double kWeight = 100.0;   ///< of that: a few well-known landmarks outweigh it

  // of azimuth, elevation
  Eigen::Vector2d sums_ = Eigen::Vector2d::Constant(0.5 * kFirst * kWeight);
  Eigen::Vector2d squares_ = Eigen::Vector2d::Constant(0.5 * kWeight);
};

}  // namespace rio

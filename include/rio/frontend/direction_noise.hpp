// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: tells in flight, by the Dopplers alone, whether the directions of a radar are less noisy
// than configured. A sigma of elevation told twice too large bends every term that corrects for it,
// and nothing in the innovations says so.
//
// r_i: Doppler residual of a static point from the velocity of its own scan, which weighted least
// squares of n points take 1 - h_i of its variance (h_i its leverage). With the gains
// g_i = (sigma_D^2, (v . s_az)^2, (v . s_el)^2) and variances relative to the configured ones:
// (E1) E r_i^2 = (1 - h_i) V_i, V_i = g_i . theta
// (E2) I = sum w_i g_i g_i^T, w_i = (1 - h_i) / (2 V_i^2): information of Gaussian residuals;
//      theta = (I + I_0)^-1 (sum w_i g_i r_i^2 / (1 - h_i) + I_0 1), I_0 = 1: a configured
//      variance may be wrong by its own size
// (E3) sigma^2 is multiplied by min(1, theta + 3 sigma_theta): residuals that are too large have
//      many causes (movers, wrong cells, folds), residuals that are too small only this one
// Reference: Searle, Casella and McCulloch, Variance Components, 1992, ch. 6 (E2).
#pragma once

#include <Eigen/Core>

#include "rio/frontend/frontend.hpp"

namespace rio {

/// Of one radar. O(points) a scan, no allocation.
class DirectionNoise {
 public:
  explicit DirectionNoise(const RadarOptions& radar)
      : grid_(radar.doppler_resolution), apart_(2.0 * radar.noise_distance) {}

  /// Multiplies the sigmas of the directions of a scan by what is known so far (E3).
  void apply(DetectionList* scan) const;

  /// Takes the static set of a scan whose sigmas have been multiplied, unless its errors are those
  /// of the last one (noise_distance), or its speed is of a few cells of the Doppler's grid, where
  /// the points have the same rounding error.
  /// @param distance travelled [m]
  void observe(const Observations& seen, double distance);

 private:
  double grid_;                                       ///< [m/s]
  double apart_;                                      ///< [m]
  double distance_ = 0.0;                             ///< travelled at the last scan taken [m]
  Eigen::Vector2d factor_ = Eigen::Vector2d::Ones();  ///< of the sigmas: azimuth, elevation
  /// I + I_0, and the sum of (E2): Doppler, azimuth, elevation
  Matrix3d information_ = Matrix3d::Identity();
  Vector3d sum_ = Vector3d::Ones();
};

}  // namespace rio

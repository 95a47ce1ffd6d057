// SPDX-License-Identifier: BSD-3-Clause
// The directions of a scan are off together.
//
// A cheap radar has three or four antennas along an axis and resolves some 30 deg: what it does not
// resolve, and multipath, puts the direction of a point off by several degrees, for as long as the
// scene looks the same. The mean of n such errors turns the whole scan, and no Doppler of it shows
// that; m is the mounting, r the rotation of T_BS that the scan sees, s the way since the last one:
// (E1) r = m Exp(d),  cov d = sigma^2 / n in elevation and azimuth
// (E2) d is a first-order Gauss-Markov process over the way: d <- a d + q,  a = exp(-s / L),
//      cov q = (1 - a^2) cov d
// (E3) in the errors of r and m:  dr <- a dr + (1 - a) dm + q
// All measurements of the radar see r, whose columns are those of T_BS; m has its own, which only
// (E3) couples with them. n is a mean over scans: with many points little is left of it.
// Reference: Gelb, Applied Optimal Estimation, 1974, sec. 3.8 (Gauss-Markov process).
#pragma once

#include <cmath>

#include "rio/core/so3.hpp"
#include "rio/state/estimate.hpp"
#include "rio/types.hpp"

namespace rio {

/// cov d of (E1), of the axes of S [rad^2].
/// @param sigma of one point [rad]
/// @param points of a scan
inline Vector3d scene_variance(double sigma, double points) {
  // nothing turns all directions about the boresight; not zero, so that its information is finite
  constexpr double kAboutBoresight = 0.01;
  return sigma * sigma / points * Vector3d(kAboutBoresight, 1.0, 1.0);
}

/// (E2) over a distance.
struct SceneStep {
  /// @param distance travelled [m]
  /// @param sigma of one point [rad]
  SceneStep(double distance, double sigma, double points)
      : decay(std::exp(-distance / kLength)),
        variance((1.0 - decay * decay) * scene_variance(sigma, points)) {}

  /// The mean of (E3).
  void apply(RadarState* radar) const {
    const Quaternion& m = radar->mounting;
    const Vector3d d = quaternion_log(m.conjugate() * radar->T_BS.rotation);
    radar->T_BS.rotation = (m * quaternion_exp(decay * d)).normalized();
  }

  static constexpr double kLength = 3.0;  ///< L: other reflectors, or others in front of them [m]

  double decay;       ///< a
  Vector3d variance;  ///< cov q, of the axes of S [rad^2]
};

}  // namespace rio

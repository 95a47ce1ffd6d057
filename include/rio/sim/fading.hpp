// SPDX-License-Identifier: BSD-3-Clause
// Interference inside a scattering object: its echo fades and its measured position wanders while
// the radar moves; both are constant while nothing moves.
//
// (E1) x <- k x + sqrt(1 - k^2) n, k = exp(-way / distance): unit variance, first order in the
//      distance travelled (way) since the last update; the distance of the noise is the shorter one
#pragma once

#include <cstdint>
#include <vector>

#include "rio/sim/random.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// State of the interference in one object; every component has unit variance.
struct Speckle {
  using Noise = Eigen::Vector4d;
  double fading = 0.0;                 ///< of the strength
  Vector3d wander = Vector3d::Zero();  ///< of the scattering centre, axes of W
  Noise noise = Noise::Zero();         ///< of the measured range, azimuth, elevation and Doppler
  double path = 0.0;                   ///< distance travelled by radar and object at this state [m]
};
using Speckles = std::vector<Speckle>;

/// Creates and ages speckles.
class Fading {
 public:
  /// @param distance e-folding distance of strength and scattering centre [m]
  /// @param noise_distance same, of the measurement noise [m]
  Fading(std::uint64_t seed, double distance, double noise_distance);

  Speckles make(std::size_t count);

  /// Ages `s` to the distance `path` travelled by radar and object [m] and returns it.
  const Speckle& advance(double path, Speckle& s);

  /// A fresh value for every scan, unit variance.
  double flicker() { return random_.normal(); }

 private:
  Speckle::Noise normal4();

  double distance_;
  double noise_distance_;
  Random random_;
  Random noise_random_;
};

}  // namespace rio::sim

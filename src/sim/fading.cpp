// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/fading.hpp"

#include <cmath>

namespace rio::sim {

Fading::Fading(std::uint64_t seed, double distance, double noise_distance)
    : distance_(distance),
      noise_distance_(noise_distance),
      random_(seed, 5),
      noise_random_(seed, 10) {}

Speckles Fading::make(std::size_t count) {
  Speckles speckles(count);
  for (Speckle& s : speckles) {
    s.fading = random_.normal();
    s.wander = random_.normal3();
    s.noise = normal4();
  }
  return speckles;
}

const Speckle& Fading::advance(double path, Speckle& s) {
  const double way = path - s.path;
  s.path = path;
  if (way == 0.0) return s;
  const double keep = std::exp(-way / distance_);  // (E1)
  const double fresh = std::sqrt(1.0 - keep * keep);
  s.fading = keep * s.fading + fresh * random_.normal();
  s.wander = keep * s.wander + fresh * random_.normal3();
  const double keep_noise = std::exp(-way / noise_distance_);
  s.noise = keep_noise * s.noise + std::sqrt(1.0 - keep_noise * keep_noise) * normal4();
  return s;
}

Speckle::Noise Fading::normal4() {
  const Vector3d head = noise_random_.normal3();
  return {head.x(), head.y(), head.z(), noise_random_.normal()};
}

}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
// Random numbers of the simulator: PCG32 (O'Neill, 2014) with independent streams, and Box-Muller.
// The standard distributions are not used, since their output differs between libraries.
#pragma once

#include <cstdint>

#include "rio/types.hpp"

namespace rio::sim {

/// Deterministic generator; two generators that differ in seed or stream are independent.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  std::uint32_t next();
  /// In [0, 1), 53 random bits.
  double uniform();
  /// In [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Zero mean, unit variance.
  double normal();
  /// Three independent components of unit variance.
  Vector3d normal3();
  /// Uniform in the box between two corners.
  Vector3d in_box(const Vector3d& low, const Vector3d& high);

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
// Random numbers of the simulator: PCG32 (O'Neill, 2014) with independent streams, and Box-Muller.
// The standard distributions are not used because their output differs between libraries.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "rio/types.hpp"

namespace rio::sim {

/// Deterministic generator; two generators that differ in seed or stream are independent.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : increment_((stream << 1U) | 1U) {
    next();
    state_ += seed;
    next();
  }

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto turn = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> turn) | (shifted << ((32U - turn) & 31U));
  }
  /// In [0, 1), 53 random bits.
  double uniform() {
    const std::uint64_t high = next() >> 5U;
    const std::uint64_t low = next() >> 6U;
    return static_cast<double>((high << 26U) | low) * 0x1p-53;
  }
  /// In [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Zero mean, unit variance.
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }
  /// Three independent components of unit variance.
  Vector3d normal3() {
    const double x = normal();
    const double y = normal();
    const double z = normal();
    return {x, y, z};
  }
  /// Uniform in the box between two corners.
  Vector3d in_box(const Vector3d& low, const Vector3d& high) {
    const double x = uniform(low.x(), high.x());
    const double y = uniform(low.y(), high.y());
    const double z = uniform(low.z(), high.z());
    return {x, y, z};
  }

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
// Quaternions from decimal text, which are never exactly of unit length.
#pragma once

#include <cmath>
#include <optional>

#include "rio/types.hpp"

namespace rio::io {

/// Normalised if its length is within 1 % of one, else empty (also for NaN). A quaternion that is
/// unit to rounding is unchanged, so that one written in full precision reads back to the bit.
inline std::optional<Quaternion> unit_quaternion(double w, double x, double y, double z) {
  const Quaternion q(w, x, y, z);
  const double error = std::abs(q.norm() - 1.0);
  if (!(error < 0.01)) return std::nullopt;
  if (error < 1e-12) return q;
  return Quaternion(q.normalized());
}

}  // namespace rio::io

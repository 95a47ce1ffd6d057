// SPDX-License-Identifier: BSD-3-Clause
// The faces and edges of a room as mirrors: images of points, and highlights, where a flat wall
// (mirror) or the corner of two (dihedral) reflects the radar's own wave straight back. A highlight
// is at the foot of the radar's perpendicular on the surface, so it moves along with the radar.
// Frame W, metres.
//
// (E1) distance d to a plane or a line with foot f: d/dt |f - p| = -u . v with u = (f - p) / d,
//      since the foot moves at right angles to u. The range rate is that of a point at rest.
// (E2) RCS at distance r: that at 1 m times r^2 for a plane (the echo of a mirror image falls with
//      r^2 instead of r^4), times r for an edge (r^3). Knott et al., Radar Cross Section, 2004.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "rio/sim/random.hpp"
#include "rio/sim/room.hpp"
#include "rio/types.hpp"

namespace rio::sim {

inline constexpr int kPlanes = 6;                    ///< indices 0..5: low x, high x, low y, ...
inline constexpr int kHighlights = kPlanes + 3 * 4;  ///< indices 6..17: four edges along each axis

/// Foot of the perpendicular from `p_W` on a face or edge; empty if it lies beyond its border.
std::optional<Vector3d> perpendicular_foot(const Room& room, int index, const Vector3d& p_W);

/// Images of a point in the six faces, in their order.
std::array<Vector3d, kPlanes> mirror_images(const Room& room, const Vector3d& point_W);

/// Cross sections of the faces and edges of one room.
class Highlights {
 public:
  explicit Highlights(std::uint64_t seed);

  /// Of one face or edge seen from `range` [m], in dB(m^2).
  double rcs_dbsm(int index, double range) const;

 private:
  std::array<double, kHighlights> rcs_1m_{};
};

}  // namespace rio::sim

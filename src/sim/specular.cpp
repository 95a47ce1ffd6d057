// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/specular.hpp"

#include <cmath>

namespace rio::sim {

std::optional<Vector3d> perpendicular_foot(const Room& room, int index, const Vector3d& p_W) {
  Vector3d foot_W = p_W;
  const auto put_on_side = [&](int axis, bool high) {
    foot_W[axis] = high ? room.high_W[axis] : room.low_W[axis];
  };
  if (index < kPlanes) {
    put_on_side(index / 2, index % 2 == 1);
  } else {
    const int edge = index - kPlanes;
    const int along = edge / 4;
    put_on_side((along + 1) % 3, edge % 2 == 1);
    put_on_side((along + 2) % 3, edge % 4 >= 2);
  }
  const bool beyond =
      (foot_W.array() < room.low_W.array()).any() || (foot_W.array() > room.high_W.array()).any();
  if (beyond) return {};
  return foot_W;
}

std::array<Vector3d, kPlanes> mirror_images(const Room& room, const Vector3d& point_W) {
  std::array<Vector3d, kPlanes> images_W;
  images_W.fill(point_W);
  for (int axis = 0; axis < 3; ++axis) {
    const auto low = 2 * static_cast<std::size_t>(axis);
    images_W.at(low)[axis] = 2.0 * room.low_W[axis] - point_W[axis];
    images_W.at(low + 1)[axis] = 2.0 * room.high_W[axis] - point_W[axis];
  }
  return images_W;
}

Highlights::Highlights(std::uint64_t seed) {
  // A large smooth plane has +5 dB(m^2) at 1 m (pi r^2); plaster reflects a tenth of that
  // specularly and scatters most of it.
  constexpr double kPlaneRcs = -15.0;  // [dB(m^2)]
  constexpr double kEdgeRcs = -18.0;
  constexpr double kRcsSigma = 6.0;
  Random random(seed, 9);
  for (int i = 0; i < kHighlights; ++i) {
    rcs_1m_.at(static_cast<std::size_t>(i)) =
        (i < kPlanes ? kPlaneRcs : kEdgeRcs) + kRcsSigma * random.normal();
  }
}

double Highlights::rcs_dbsm(int index, double range) const {  // (E2)
  const double growth = index < kPlanes ? 20.0 : 10.0;
  return rcs_1m_.at(static_cast<std::size_t>(index)) + growth * std::log10(range);
}

}  // namespace rio::sim

// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/radar_model.hpp"

#include <algorithm>
#include <cmath>

namespace rio::sim {

Pose default_radar_mount(double pitch) {
  return {.rotation = Quaternion(std::cos(0.5 * pitch), 0.0, std::sin(0.5 * pitch), 0.0),
          .translation = {0.10, 0.0, -0.05}};
}

std::vector<Pose> radar_mounts(const Pose& first, std::size_t count) {
  std::vector<Pose> out = {first};
  for (std::size_t r = 1; r < count; ++r) {
    if (count == 2) {
      const Quaternion down(Eigen::AngleAxisd(90.0 * kDegree, Vector3d::UnitY()));
      out.push_back({down, Vector3d(0.0, 0.0, -0.05)});
      continue;
    }
    const double share = static_cast<double>(r) / static_cast<double>(count);
    const Quaternion turn(Eigen::AngleAxisd(360.0 * kDegree * share, Vector3d::UnitZ()));
    out.push_back({(turn * first.rotation).normalized(), turn * first.translation});
  }
  return out;
}

RadarModel RadarModel::ideal() {
  RadarModel model;
  model.quantize = model.ambiguous = model.specular = false;
  model.angle_grid = model.weak_angle_growth = 0.0;
  model.wander_sigma = model.outlier_share = 0.0;
  model.fresh_noise = 1.0;
  return model;
}

const char* to_string(Cause cause) {
  constexpr const char* kNames[] = {"static", "mirror",      "double_bounce", "specular",
                                    "person", "false_alarm", "vehicle"};
  return kNames[static_cast<std::size_t>(cause)];
}

double fold(double value, double limit) {
  const double folded = value - 2.0 * limit * std::floor((value + limit) / (2.0 * limit));
  return folded < limit ? folded : -limit;
}

Polar Polar::of(const Vector3d& point_S) {
  return {point_S.norm(), std::atan2(point_S.y(), point_S.x()),
          std::atan2(point_S.z(), point_S.head<2>().norm())};
}

Vector3d Polar::point() const {  // (E1)
  const double level = range * std::cos(elevation);
  return {level * std::cos(azimuth), level * std::sin(azimuth), range * std::sin(elevation)};
}

Vector3d snap_direction(const Vector3d& point_S, double grid) {
  const double range = point_S.norm();
  if (grid <= 0.0 || range <= 0.0) return point_S;
  double y = std::round(point_S.y() / range / grid) * grid;
  double z = std::round(point_S.z() / range / grid) * grid;
  while (y * y + z * z > 1.0) {
    double& larger = std::abs(y) > std::abs(z) ? y : z;
    larger = std::copysign((std::round(std::abs(larger) / grid) - 1.0) * grid, larger);
  }
  return range * Vector3d(std::sqrt(std::max(0.0, 1.0 - y * y - z * z)), y, z);
}

}  // namespace rio::sim

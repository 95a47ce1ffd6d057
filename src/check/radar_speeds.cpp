// SPDX-License-Identifier: BSD-3-Clause
// The velocities of the radar that motion.hpp compares with the IMU.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "check/motion.hpp"
#include "check/numbers.hpp"
#include "rio/checks/stamp_guard.hpp"
#include "rio/frontend/ego_velocity.hpp"
#include "rio/models/detection.hpp"

namespace rio::check {

namespace {

/// Scans farther apart do not confirm each other: two on each side of a slow radar [s].
double neighbourhood(const std::vector<RadarSpeed>& speeds) {
  constexpr double kShortest = 0.25;
  constexpr double kLongest = 0.75;  // the velocity bends within it
  std::vector<double> periods;
  for (std::size_t k = 1; k < speeds.size(); ++k) {
    periods.push_back(to_seconds(speeds[k].time - speeds[k - 1].time));
  }
  const double two = periods.empty() ? 0.0 : 2.5 * median(std::move(periods));
  return std::clamp(two, kShortest, kLongest);
}

/// Whether the velocity agrees with its neighbours, unlike a wrong fold, or a person passing by.
bool is_alike(const std::vector<RadarSpeed>& speeds, std::size_t k, double near) {
  constexpr double kNoise = 0.3;    // [m/s]
  constexpr std::size_t kMost = 8;  // on each side
  std::array<std::vector<double>, 3> around;
  const std::size_t end = std::min(speeds.size(), k + kMost + 1);
  for (std::size_t i = k - std::min(k, kMost); i < end; ++i) {
    if (i == k || std::abs(to_seconds(speeds[i].time - speeds[k].time)) > near) continue;
    for (int axis = 0; axis < 3; ++axis) {
      around[static_cast<std::size_t>(axis)].push_back(speeds[i].v_S[axis]);
    }
  }
  if (around[0].size() < 3) return false;
  const Vector3d middle(median(around[0]), median(around[1]), median(around[2]));
  const double sigma = kModels * std::sqrt(1.0 / speeds[k].weight - 1.0);
  return (speeds[k].v_S - middle).norm() < kNoise + 3.0 * sigma;
}

/// The velocity of the scan before, if recent. It is an additional hypothesis and saves trying all
/// folds of every triple; the scan alone decides whether it is accepted.
std::optional<RadarVelocity> as_before(const std::vector<RadarSpeed>& speeds, Time time) {
  constexpr double kLong = 0.25;         // [s]
  constexpr double kAcceleration = 2.0;  // [m/s^2]
  if (speeds.empty()) return std::nullopt;
  const double dt = to_seconds(time - speeds.back().time);
  if (dt <= 0.0 || dt > kLong) return std::nullopt;
  const double sigma = kModels + kAcceleration * dt;
  return RadarVelocity{speeds.back().v_S, Matrix3d::Identity() * sigma * sigma};
}

}  // namespace

std::vector<RadarSpeed> radar_speeds(const Scans& scans, Options options) {
  constexpr double kWeak = 1.0;  // a less certain velocity carries no information [m/s]
  options.radar.fov_azimuth = 7.0;
  options.radar.fov_elevation = 7.0;
  EgoVelocityRansac ransac(options.frontend, options.radar.max_doppler);
  DetectionList list;
  EgoVelocity ego;
  std::vector<RadarSpeed> all;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const RadarScan scan = scans.get(i);
    if (!is_stamp(scan.time)) continue;
    filter_detections(scan, options.radar, options.frontend.max_detections, list);
    ransac.estimate(list, as_before(all, scan.time), &ego);
    if (!ego.valid || !ego.covariance) continue;
    const double variance = ego.covariance->trace() / 3.0;
    if (!(variance < kWeak * kWeak)) continue;
    all.push_back({scan.time, ego.v_S, kModels * kModels / (kModels * kModels + variance),
                   static_cast<double>(ego.inliers) / static_cast<double>(list.items.size())});
  }
  std::vector<RadarSpeed> out;
  const double near = neighbourhood(all);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (is_alike(all, k, near)) out.push_back(all[k]);
  }
  return out;
}

Scans without_points_of(const std::vector<RadarSpeed>& speeds, const Scans& scans,
                        double max_doppler) {
  constexpr double kAgree = 0.3;  // [m/s]
  std::size_t k = 0;
  return changed(scans, [&](std::size_t, RadarScan* scan) {
    if (k == speeds.size() || speeds[k].time != scan->time) return;
    std::erase_if(scan->detections, [&](const RadarDetection& d) {
      const double off = d.range_rate + d.point_S.normalized().dot(speeds[k].v_S);
      const double folded = max_doppler > 0.0 ? std::remainder(off, 2.0 * max_doppler) : off;
      return std::abs(folded) < kAgree;
    });
    ++k;
  });
}

Scans from_zenith(const Scans& scans) {
  return changed(scans, [](std::size_t, RadarScan* scan) {
    for (RadarDetection& d : scan->detections) {
      const Vector3d p = d.point_S;
      const double across = std::copysign(p.head<2>().norm(), p.x());
      if (across != 0.0) d.point_S << p.z() / across * p.head<2>(), across;
    }
  });
}

double noise(const std::vector<RadarSpeed>& speeds) {
  const double near = neighbourhood(speeds);
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t k = 2; k < speeds.size(); ++k) {
    if (!(to_seconds(speeds[k].time - speeds[k - 2].time) < near)) continue;
    const Vector3d bend = speeds[k].v_S - 2.0 * speeds[k - 1].v_S + speeds[k - 2].v_S;
    sum += speeds[k - 1].weight * bend.squaredNorm() / 6.0;
    weight += speeds[k - 1].weight;
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

}  // namespace rio::check

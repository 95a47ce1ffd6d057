// SPDX-License-Identifier: BSD-3-Clause
// The scans of a radar in half the memory: the data for the checks contiguous, the rest only if
// present.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "rio/types.hpp"

namespace rio::check {

/// The part of RadarDetection used by the checks.
struct Point {
  Vector3d point_S;
  double range_rate;
  double snr_db;
};

struct ScanView {
  Time time{0};
  std::span<const Point> detections;
};

class Scans {
 public:
  Scans() = default;
  explicit Scans(const std::vector<RadarScan>& scans) {
    std::size_t points = 0;
    for (const RadarScan& scan : scans) points += scan.detections.size();
    reserve(scans.size(), points);
    for (const RadarScan& scan : scans) push_back(scan);
  }

  void reserve(std::size_t scans, std::size_t points) {
    scans_.reserve(scans);
    points_.reserve(points);
  }

  void push_back(const RadarScan& scan) {
    scans_.push_back({scan.time, points_.size(), kNone});
    bool more = false;
    for (const RadarDetection& d : scan.detections) {
      points_.push_back({d.point_S, d.range_rate, d.snr_db});
      for (const double value : rest_of(d)) more = more || value != 0.0;
    }
    if (!more) return;
    scans_.back().rest = rest_.size();
    for (const RadarDetection& d : scan.detections) rest_.push_back(rest_of(d));
  }

  bool empty() const { return scans_.empty(); }
  std::size_t size() const { return scans_.size(); }
  /// Those of all scans.
  std::span<const Point> points() const { return points_; }

  ScanView operator[](std::size_t i) const {
    const std::size_t end = i + 1 < scans_.size() ? scans_[i + 1].points : points_.size();
    return {scans_[i].time, std::span(points_).subspan(scans_[i].points, end - scans_[i].points)};
  }

  /// The complete scan, as added.
  RadarScan get(std::size_t i) const {
    const ScanView view = (*this)[i];
    RadarScan scan{view.time, {}};
    scan.detections.reserve(view.detections.size());
    for (std::size_t k = 0; k < view.detections.size(); ++k) {
      const Point& point = view.detections[k];
      const Rest rest = scans_[i].rest == kNone ? Rest{} : rest_[scans_[i].rest + k];
      scan.detections.push_back({point.point_S, point.range_rate, point.snr_db, rest[0], rest[1],
                                 rest[2], rest[3], rest[4]});
    }
    return scan;
  }

  /// Memory of a scan with as many points [B].
  static std::size_t bytes(const RadarScan& scan) {
    return sizeof(Scan) + scan.detections.size() * sizeof(Point);
  }

 private:
  static constexpr auto kNone = static_cast<std::size_t>(-1);
  struct Scan {
    Time time;
    std::size_t points;  ///< index of its first one
    std::size_t rest;    ///< of its first one; kNone: all zero
  };
  using Rest = std::array<double, 5>;  ///< noise, sigmas of range, angles and Doppler

  static Rest rest_of(const RadarDetection& d) {
    return {d.noise_db, d.sigma_range, d.sigma_azimuth, d.sigma_elevation, d.sigma_doppler};
  }

  std::vector<Scan> scans_;
  std::vector<Point> points_;
  std::vector<Rest> rest_;
};

/// With change(index, &scan) for each scan.
template <class Change>
Scans changed(const Scans& scans, const Change& change) {
  Scans out;
  out.reserve(scans.size(), scans.points().size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    RadarScan scan = scans.get(i);
    change(i, &scan);
    out.push_back(scan);
  }
  return out;
}

}  // namespace rio::check

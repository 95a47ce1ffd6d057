// SPDX-License-Identifier: BSD-3-Clause
// What a simulated radar has sent, and what came of it.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "rio/io/dataset.hpp"

namespace rio::test {

/// The points of the scans as they were on the wire, sorted.
inline std::vector<std::vector<std::array<float, 4>>> wire_points(const io::Dataset& dataset) {
  std::vector<std::vector<std::array<float, 4>>> scans;
  for (const RadarScan& scan : dataset.scans) {
    auto& points = scans.emplace_back();
    for (const RadarDetection& d : scan.detections) {
      const Eigen::Vector3f p = d.point_S.cast<float>();
      points.push_back({p.x(), p.y(), p.z(), static_cast<float>(d.range_rate)});
    }
  }
  std::sort(scans.begin(), scans.end());
  return scans;
}

}  // namespace rio::test

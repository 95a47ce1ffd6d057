// SPDX-License-Identifier: BSD-3-Clause
// Growth of the time of an update with the problem size.
#pragma once

#include <string>
#include <vector>

namespace rio::bench {

/// One measured point of a curve.
struct GrowthPoint {
  double size = 0.0;    ///< actual points, landmarks, clones or states, mean
  double median = 0.0;  ///< of an update [us]
  double p99 = 0.0;
};

/// One preset and back-end along one axis.
struct GrowthCurve {
  std::string label;
  std::vector<GrowthPoint> points;
};

/// One axis, from the smallest size to the largest that the options allow.
struct Growth {
  std::string title;  ///< "detections"
  std::string size;   ///< "detections in a scan"
  std::vector<GrowthCurve> curves;
};

/// Axes: detections, landmarks, clones, window.
/// @param seconds of flight for each point
std::vector<Growth> measure_growth(double seconds);

/// As an SVG file; both axes of a panel linear, times in milliseconds.
std::string growth_chart(const std::vector<Growth>& growths);

}  // namespace rio::bench

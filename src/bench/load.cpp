// SPDX-License-Identifier: BSD-3-Clause
#include "bench/load.hpp"

#include <algorithm>
#include <cmath>

#include "rio/io/simulation.hpp"

namespace rio::bench {

namespace {

constexpr double kUsual = 20.0;  ///< points that hardly any scan of the default scenario misses

/// The room and radar of the default scenario, finer if more points are needed.
sim::Scenario scenario_of(std::size_t detections, double seconds) {
  sim::Scenario s;
  s.max_duration = s.path.stand_before + seconds;
  const double more = std::max(1.0, static_cast<double>(detections) / kUsual);
  for (double* density : {&s.room.floor_density, &s.room.wall_density, &s.room.ceiling_density,
                          &s.room.clutter_density}) {
    *density *= more;
  }
  s.radar.max_static = static_cast<int>(std::ceil(1.2 * static_cast<double>(detections)));
  s.radar.range_resolution /= std::sqrt(more);
  s.radar.doppler_resolution /= std::sqrt(more);
  s.radar.snr_1m_db += 15.0 * std::log10(more);
  return s;
}

void keep_strongest(std::size_t count, RadarScan* scan) {
  if (scan->detections.size() <= count) return;
  std::stable_sort(
      scan->detections.begin(), scan->detections.end(),
      [](const RadarDetection& a, const RadarDetection& b) { return a.snr_db > b.snr_db; });
  scan->detections.resize(count);
}

}  // namespace

io::Dataset make_load(std::size_t detections, double seconds) {
  io::Dataset load = io::dataset_of(sim::simulate_flight(scenario_of(detections, seconds)));
  for (RadarScan& scan : load.scans) keep_strongest(detections, &scan);
  return load;
}

}  // namespace rio::bench

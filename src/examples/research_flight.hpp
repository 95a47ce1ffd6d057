// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight through the research API, for the examples that replace a part of it.
#pragma once

#include <rio/models/detection.hpp>
#include <rio/propagate/imu_buffer.hpp>
#include <rio/sim/flight.hpp>

/// 30 m through the default room, and the options with its mounting.
struct ResearchFlight {
  ResearchFlight() {
    rio::sim::Scenario scenario;
    scenario.path.length = 30.0;
    flight = rio::sim::simulate_flight(scenario);
    options.radar.T_BS = flight.configured_T_BS;
  }

  rio::sim::Flight flight;
  rio::Options options;
};

/// Flies with a rio::Pipeline<...> from the true start; returns the position error at the end [m].
template <class Pipeline>
double fly(const ResearchFlight& research, Pipeline* pipeline) {
  const auto& [flight, options] = research;
  rio::BodyCovariance P0 = rio::BodyCovariance::Identity() * 1e-4;  // 1 cm, 0.6 deg, 1 cm/s
  P0.diagonal().segment<3>(rio::body::kGyroBias).setConstant(2.5e-5);
  P0.diagonal().segment<3>(rio::body::kAccelBias).setConstant(2.5e-3);
  pipeline->reset(flight.configured_start(), P0);
  rio::ImuBuffer imu(options.timing, options.imu);
  rio::DetectionList scan;
  std::size_t next = 0;
  for (const rio::ImuSample& sample : flight.imu) {
    imu.push_back(sample);
    for (; next < flight.scans.size() &&
           pipeline->measured_at(flight.scans[next].time) <= sample.time;
         ++next) {
      filter_detections(flight.scans[next], options.radar, options.frontend.max_detections, scan);
      (void)pipeline->process(scan, imu);  // kNumerical: the scan was not used
      imu.forget_before(pipeline->estimate().nav.time);
    }
  }
  const rio::NavState& end = pipeline->estimate().nav;
  return (end.p_WB - flight.truth_at(end.time).p_WB).norm();
}

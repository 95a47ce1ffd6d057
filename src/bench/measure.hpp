// SPDX-License-Identifier: BSD-3-Clause
// What an update costs on this machine: a load, its measurement, its growth with the problem size.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::bench {

/// A simulated flight through a room, always the same bytes. Above twenty points a scan the radar
/// is finer and sees weaker echoes in a denser room; the strongest points of each scan are kept.
/// @param detections in each scan; near walls there may be fewer
/// @param seconds in the air, at a scan rate of 15 Hz and 200 Hz of the IMU
io::Dataset make_load(std::size_t detections, double seconds);

/// Median and p99 of a list of times [us].
struct Spread {
  double median = 0.0;
  double p99 = 0.0;
};

/// In flight: scans at rest do not count.
struct Figures {
  std::size_t updates = 0;
  double detections = 0.0;  ///< kept, mean per scan
  double clones = 0.0;      ///< mean after an update
  double landmarks = 0.0;
  Spread update;           ///< front-end to promotion
  double imu_step = 0.0;   ///< per IMU sample, with its covariance, mean [us]
  double create = 0.0;     ///< median of several [us]
  std::size_t memory = 0;  ///< of the Odometry, all of it allocated at create(); 0: unknown
  double real_time = 0.0;  ///< length of the data over the total time of all calls
};

/// Runs the recording through an Odometry, fed as in flight, with static alignment.
/// @throws std::runtime_error if the options are invalid, or no scan was processed in flight
Figures measure(const io::Dataset& load, const Options& options);

/// A preset with the back-end and the sensor properties of the recording.
/// @throws std::runtime_error if there is no such preset
Options options_for(const io::Dataset& load, const std::string& preset_name, BackEnd backend);

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

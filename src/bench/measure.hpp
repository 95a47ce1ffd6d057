// SPDX-License-Identifier: BSD-3-Clause
// Cost of the estimator on a recording: CPU time of its steps, memory, speed relative to real time.
#pragma once

#include <cstddef>
#include <string>

#include "rio/io/dataset.hpp"
#include "rio/options.hpp"

namespace rio::bench {

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

}  // namespace rio::bench

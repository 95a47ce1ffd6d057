// SPDX-License-Identifier: BSD-3-Clause
// An endless flight: ten minutes from the ground and back to the same spot, repeatedly, each time
// on another path. The sensors are simulated on demand, so that memory does not grow.
#pragma once

#include <cstdint>
#include <optional>

#include "rio/sim/imu.hpp"
#include "rio/sim/radar.hpp"
#include "rio/sim/scenario.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::experiment {

/// Sensors of a scenario carried along an endless flight. Its path is not the scenario's.
class EndlessFlight {
 public:
  explicit EndlessFlight(const sim::Scenario& scenario);

  /// The next sample, 1 / ImuModel::rate_hz after the one before; the first is at the start.
  ImuSample next_imu();
  /// Stamp of the next scan.
  Time next_scan_time() const;
  /// The next scan, 1 / RadarModel::rate_hz after the one before; never at the stamp of a sample.
  RadarScan next_scan();
  /// Exact pose and velocity within ten minutes of the newest sample or scan, biases zero.
  NavState truth(Time time) { return piece_at(time).at(time).nav; }

 private:
  /// One of the flights from rest to rest.
  struct Piece {
    std::int64_t number = -1;
    sim::Trajectory trajectory;
  };

  const sim::Trajectory& piece_at(Time time);

  sim::Scenario scenario_;
  Piece pieces_[2];  ///< even and odd one in use: scans and samples need not be in step
  sim::ImuSimulator imu_;
  sim::RadarSimulator radar_;
  std::int64_t samples_ = 0;
  std::int64_t scans_ = 0;
};

}  // namespace rio::experiment

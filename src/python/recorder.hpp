// SPDX-License-Identifier: BSD-3-Clause
// Collects what a replay estimates, scan by scan, in vectors that numpy takes over.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "rio/rio.hpp"

namespace rio::python {

/// A row of Result.scans.
struct ScanRow {
  std::int64_t time;  ///< [ns]
  std::uint8_t radar;
  std::int32_t detections;
  std::int32_t detections_kept;
  std::int32_t static_detections;
  double ego_velocity[3];  ///< radar axes [m/s]
  bool ego_velocity_valid;
  std::int32_t trails;
  std::int32_t clones;
  std::int32_t landmarks;
  std::int32_t landmarks_matched;
  std::int32_t landmarks_added;
  std::int32_t landmarks_removed;
  bool at_rest;
  std::uint8_t health;   ///< index of rio.HEALTH_STATES
  std::int32_t quality;  ///< 0 to 100
};

/// A row of Result.landmark_states.
struct LandmarkRow {
  std::int64_t time;        ///< of the scan [ns]
  double position[3];       ///< world axes [m]
  double covariance[3][3];  ///< of it [m^2]
  std::int64_t last_seen;   ///< [ns]
};

struct Event {
  std::int64_t time;  ///< of the scan [ns]
  std::string what;
  double value;  ///< of a re-opened position its sigma [m]; else zero
};

class Recorder {
 public:
  /// After each processed scan. Of scans at the same instant, as of several radars, the last one is
  /// the estimate of that instant, as in the files that `rio replay` writes.
  void add(const Odometry& odometry);

  std::vector<std::int64_t> times;
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<double, 4>> orientations;
  std::vector<std::array<double, 3>> velocities;
  std::vector<std::array<double, 3>> gyro_biases;
  std::vector<std::array<double, 3>> accel_biases;
  std::vector<std::array<double, body::kSize * body::kSize>> covariances;
  std::vector<ScanRow> scans;
  std::vector<InnovationRow> innovations;
  std::vector<LandmarkRow> landmark_states;
  std::vector<Event> events;

 private:
  void add_state(const NavState& state, const BodyCovariance& covariance);
  void add_scan(const UpdateReport& report);
  void add_landmarks(const Odometry& odometry);
  void add_events(const UpdateReport& report, const Counters& counters);

  HealthState health_ = HealthState::kInitializing;  ///< the last one
  bool at_rest_ = false;
  std::uint64_t clock_restarts_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace rio::python

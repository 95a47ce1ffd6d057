// SPDX-License-Identifier: BSD-3-Clause
// The record of a run: everything the estimator says at a scan, once, as plain values. Whoever
// shows or stores a run (report, CSV, MCAP, live view) is a RunSink and reads nothing else.
//
//   RunStart     before the first scan: name, options, truth
//   ScanRecord   each processed scan: state and covariance, calibration, the update stage by stage,
//                every innovation with sigma, NIS and gate, every point with label, world position
//                and residual, every landmark, health, counters
//   Event        what happened between two scans: start, gap, late scan, reset, health change
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "rio/eval/stamped_pose.hpp"
#include "rio/rio.hpp"

namespace rio::view {

/// The estimate at one scan, and what the update made of it.
struct ScanRecord {
  Time stamp{0};  ///< of the scan as recorded; state.time is corrected by the time offset
  std::size_t radar = 0;
  NavState state;
  BodyCovariance covariance = BodyCovariance::Zero();  ///< of the state, order of namespace body
  Pose T_BS;                                           ///< of that radar, as estimated
  UpdateReport report;                                 ///< with innovations, calibration and health
  std::vector<PointReport> points;
  std::vector<LandmarkReport> landmarks;
  Counters counters;

  /// 1-sigma of three elements of the body error, first element as in namespace body.
  Vector3d sigma(int block) const {
    return covariance.diagonal().segment<3>(block).cwiseMax(0.0).cwiseSqrt();
  }
};

/// The record of the last processed scan; the vectors of `out` keep their capacity.
void take_record(const Odometry& odometry, ScanRecord* out);

enum class EventKind : std::uint8_t {
  kStart,
  kGap,       ///< the IMU paused
  kDropped,   ///< scans or samples were refused: late, ahead, duplicate, damaged
  kReset,     ///< velocity, attitude or the clock were replaced
  kReopened,  ///< the position was re-opened
  kFailed,    ///< an update failed
  kHealth,    ///< the state of the health changed
};
inline constexpr std::array kEventNames = {"start",     "gap",    "dropped", "reset",
                                           "re-opened", "failed", "health"};

struct Event {
  Time time{0};  ///< of the state with which it was noticed
  EventKind kind = EventKind::kStart;
  bool serious = false;  ///< the estimate is lost, or was replaced
  std::string text;
};

/// Finds the events in a sequence of records.
class EventWatch {
 public:
  /// Events since the last record, this one included; valid until the next call.
  const std::vector<Event>& look(const ScanRecord& record);

 private:
  bool started_ = false;
  bool mounting_unknown_ = false;
  HealthState health_ = HealthState::kInitializing;
  Counters counters_;
  std::vector<Event> events_;
};

/// What is known before the first scan.
struct RunStart {
  std::string name;  ///< of the recording
  Options options;
  eval::Trajectory truth;      ///< empty: not known
  bool lay_truth_over = true;  ///< not started from the truth: worlds differ by heading and origin
  std::string version;
};

/// Takes the record of a run as it goes on.
class RunSink {
 public:
  virtual ~RunSink() = default;
  virtual void begin(const RunStart& /*start*/) {}
  virtual void add(const ScanRecord& record, const std::vector<Event>& events) = 0;
  /// Nothing more will come; files are complete afterwards. Throws if one could not be written.
  virtual void close() {}
};

/// Heading and origin that lay the truth over an estimate of the same time.
Pose laid_over(const eval::StampedPose& truth, const eval::StampedPose& estimate);

/// Reasons of the health that are active: "outliers, gated".
std::string reasons_text(const Health& health);

}  // namespace rio::view

// SPDX-License-Identifier: BSD-3-Clause
// A run made visible: whoever shows or stores it (report, CSV, MCAP, live view) is a RunSink, and
// reads from the estimator after each processed scan.
//
//   RunStart     before the first scan: name, options, truth
//   Event        what happened: start, gap, late scan, reset, health change
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rio/eval/stamped_pose.hpp"
#include "rio/rio.hpp"

namespace rio::view {

/// 1-sigma of three elements of the body error, the first one as in namespace body.
inline Vector3d sigma_of(const BodyCovariance& covariance, int first) {
  return covariance.diagonal().segment<3>(first).cwiseMax(0.0).cwiseSqrt();
}

enum class EventKind : std::uint8_t {
  kStart,
  kGap,       ///< the IMU paused
  kDropped,   ///< scans or samples were refused: late, ahead, duplicate, damaged
  kReset,     ///< velocity, attitude or the clock were replaced
  kReopened,  ///< the sigma of the position was widened
  kFailed,    ///< an update failed
  kHealth,    ///< the state of the health changed
};
inline constexpr std::array kEventNames = {"start",     "gap",    "dropped", "reset",
                                           "re-opened", "failed", "health"};

struct Event {
  Time time{0};  ///< of the scan or IMU sample with which it was noticed
  EventKind kind = EventKind::kStart;
  bool serious = false;  ///< the estimate is lost, or was replaced
  std::string text;
};

/// Finds the events of a run, looking at the estimator after each scan and each IMU sample: a
/// radar may be silent.
class EventWatch {
 public:
  /// Events since the last look; valid until the next call.
  const std::vector<Event>& after_scan(const Odometry& odometry);
  const std::vector<Event>& after_imu(const Odometry& odometry);

 private:
  void add(EventKind kind, bool serious, const std::string& text) {
    events_.push_back({time_, kind, serious, text});
  }
  void look(const Odometry& odometry);

  Time time_{0};
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
  std::optional<Time> begin{};  ///< of the recording: zero of a page; else the first scan
  std::vector<std::pair<std::string, eval::Trajectory>> others{};  ///< estimates to compare with
};

/// Follows a run as it goes on.
class RunSink {
 public:
  virtual ~RunSink() = default;
  virtual void begin(const RunStart& /*start*/) {}
  /// @param odometry right after it has processed a scan
  virtual void add(const Odometry& odometry) = 0;
  /// Before the scan that shows it, or between scans.
  virtual void add_event(const Event& /*event*/) {}
  /// Nothing more will come; files are complete afterwards. Throws if one could not be written.
  virtual void close() {}
};

/// Heading and origin that lay the truth over an estimate of the same time.
Pose laid_over(const eval::StampedPose& truth, const eval::StampedPose& estimate);

/// Reasons of the health that are active: "outliers, gated".
std::string reasons_text(const Health& health);

}  // namespace rio::view

// SPDX-License-Identifier: BSD-3-Clause
// Which scans are taken, and when: the checks of Odometry::add_scan, and the scans that wait for
// samples of the IMU or for scans of other radars.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/rio.hpp"
#include "scan_clock.hpp"
#include "scan_history.hpp"
#include "scan_queue.hpp"
#include "stamp_run.hpp"

namespace rio {

/// Stamp of the newest sample, if there is one.
inline std::optional<Time> newest_of(const ImuBuffer& imu) {
  if (imu.empty()) return std::nullopt;
  return imu.newest().time;
}

class ScanIntake {
 public:
  /// @param options kept by reference
  explicit ScanIntake(const Options& options);

  /// A scan that has arrived.
  struct Arrival {
    std::size_t radar;
    Time stamp;     ///< without steps of the radar's clock
    Time measured;  ///< by the time offset; `stamp` if that is none
  };

  /// The stamp without the steps of the radar's clock; the scan may show another one.
  Time corrected(Time stamp, std::size_t radar, const ImuBuffer& imu);
  /// The last stamp that was corrected has shown a step.
  bool clock_stepped(std::size_t radar) const { return clocks_[radar].stepped(); }

  /// Filters a scan and decides: kOk, accepted() is to be processed now; kWaiting, it is in the
  /// queue; otherwise it is refused, and counted.
  /// @param estimate its time
  Status accept(const RadarScan& scan, const Arrival& arrival, Time estimate, const ImuBuffer& imu,
                Counters* counters);
  const DetectionList& accepted() const { return accepted_; }

  /// The scans that wait, oldest first.
  const ScanQueue& queue() const { return queue_; }
  void pop() { queue_.pop_front(); }
  /// The scan may be processed: the IMU has reached it, and no earlier one can still arrive.
  bool is_ready(Time measured, std::size_t radar, const ImuBuffer& imu) const {
    return !imu.empty() && history_.is_ready(measured, radar, imu.newest().time);
  }
  /// A scan was processed.
  /// @param estimate its time afterwards
  void processed(const DetectionList& scan, Time estimate) {
    history_.process(scan.time, scan.radar, estimate);
  }

  /// Too far ahead of the IMU to wait for it.
  bool is_ahead(Time stamp, Time estimate, const ImuBuffer& imu) const;
  /// The stamps of the scans, taken or not, have gone on without a jump from `before` to `after`.
  bool goes_through(Time before, Time after) const { return stamps_.goes_through(before, after); }

  /// Starts over: the scans that wait are dropped.
  void forget(const ImuBuffer& imu);
  /// Two equal scans in a row are new ones.
  void forget_fingerprints() { history_.forget_fingerprints(); }
  /// The clock of the IMU has jumped, those of the radars perhaps, too.
  void reset_clocks();

 private:
  /// Measured before the estimate. A scan that follows the last one is not late, even if a change
  /// of the estimated time offset puts it before the estimate.
  bool is_late(const Arrival& arrival, Time estimate) const;

  const Options& options_;
  std::array<ScanClock, kMaxRadars> clocks_;
  StampRun stamps_;
  ScanHistory history_;
  ScanQueue queue_;
  DetectionList accepted_;
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Steps of the clock of one radar against that of the IMU. The lag of a scan, its stamp minus the
// newest IMU stamp at its arrival, is constant but for delays. A step of the radar's clock changes
// it for good, at a scan whose stamp does not follow the one before although it arrives when it is
// due. A late scan is the opposite: its stamp follows, but it is not due. Where the stamps of the
// IMU jump, be it a pause or a step of the clock of both sensors, the lag is as before; after a
// step of the clock of the IMU alone it is less by that jump. Where a delay of the IMU has ended it
// is less, too, but no less than before that delay.
#pragma once

#include <chrono>
#include <optional>

#include "rio/types.hpp"

namespace rio {

/// O(1) a scan, no allocation.
class ScanClock {
 public:
  /// The stamp without the steps found so far. Takes the scan as evidence of a new one.
  /// @param imu stamp of the newest IMU sample, if there is one
  Time corrected(Time stamp, std::optional<Time> imu);

  /// The last call has found a step.
  bool stepped() const { return stepped_; }
  /// Sum of the steps: as received minus corrected.
  Time shift() const { return shift_; }

  /// The stamps of the IMU have jumped, those of the radar perhaps, too.
  void imu_jumped(Time by);
  /// Starts over.
  void reset() { *this = ScanClock{}; }

 private:
  // what the estimated time offset follows, and the jitter of an arrival
  static constexpr Time kStep = std::chrono::milliseconds(100);
  static constexpr Time kSteady = std::chrono::milliseconds(50);
  static constexpr Time kPull = 4 * kStep;  // of one scan on the mean lag
  static constexpr Time kOdd =
      std::chrono::seconds(5);     // ahead of the mean lag: one stamp is wrong
  static constexpr int kMany = 5;  // scans in a row that are no coincidence
  static constexpr int kMean = 8;  // scans of the mean lag

  /// Scans in a row whose lag is not that of before.
  struct Run {
    Time lag{0};  ///< mean
    int count = 0;
  };

  void observe(Time stamp, Time imu);
  /// A scan after `interval` is due.
  bool is_due(Time interval) const { return std::chrono::abs(interval - interval_) < kStep; }

  Time shift_{0};
  bool stepped_ = false;
  std::optional<Time> jump_;    ///< of the stamps of the IMU, until the lag is as before
  std::optional<Time> newest_;  ///< stamp, corrected: late scans may come between
  Time imu_{0};                 ///< at the last scan
  Time interval_{0};            ///< usual, between scans
  Time lag_{0};                 ///< mean
  int lags_ = 0;                ///< in it
  Time least_{0};               ///< least mean so far
  Time lag_moving_{0};          ///< mean before the IMU paused
  int moving_ = 0;              ///< scans before which the IMU has gone on
  Run run_;
};

}  // namespace rio

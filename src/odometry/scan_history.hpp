// SPDX-License-Identifier: BSD-3-Clause
// What each radar has sent so far: which scan is new, and which may be processed because no earlier
// one of another radar can still arrive.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "rio/models/detection.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

class ScanHistory {
 public:
  /// @param wait longest time that a scan is held back for an earlier one of another radar [s]
  ScanHistory(std::size_t radars, double wait) : radars_(radars), wait_(from_seconds(wait)) {}

  /// Starts over, but keeps the fingerprints of the last scans.
  /// @param now newest sample of the IMU, if there is one
  void forget(std::optional<Time> now);
  /// Forgets the fingerprints.
  void forget_fingerprints();

  /// The last scan processed of this radar has this stamp.
  bool is_last(Time stamp, std::size_t radar) const {
    return of_[radar].processed && stamp == of_[radar].last;
  }
  /// The filtered scan equals the previous one of its radar, which noise excludes for a new scan.
  /// False if all range rates are zero, as at rest with a coarse grid. Stores the fingerprint.
  bool is_repeated(const DetectionList& scan);
  /// The scan follows the one processed last, and the estimate is still at the time of that one.
  bool follows_last(Time stamp, std::size_t radar, Time estimate) const {
    const OfRadar& own = of_[radar];
    return own.processed && radar == last_radar_ && stamp > own.last && estimate == last_estimate_;
  }
  /// The IMU has reached the scan, and no earlier one of another radar is expected: each other
  /// radar has sent a later one or is silent, or the scan has waited long enough.
  /// @param now newest sample of the IMU
  bool is_ready(Time measured, std::size_t radar, Time now) const;

  /// Records that a scan was accepted, to be processed or to wait.
  /// @param now newest sample of the IMU, if there is one
  void take(std::size_t radar, Time measured, std::optional<Time> now);
  /// Records that a scan was processed.
  /// @param estimate time of the estimate afterwards
  void process(Time stamp, std::size_t radar, Time estimate);

 private:
  struct OfRadar {
    Time last{0};  ///< stamp of the last scan processed
    bool processed = false;
    std::optional<Time> newest;     ///< time of measurement of the newest scan accepted
    std::optional<Time> heard;      ///< newest IMU sample at the last accepted scan or at the start
    std::uint64_t fingerprint = 0;  ///< of the last scan accepted or repeated
  };

  static constexpr Time kSilent = std::chrono::milliseconds(500);  // then no longer waited for

  std::size_t radars_;
  Time wait_;
  std::array<OfRadar, kMaxRadars> of_;
  std::size_t last_radar_ = 0;  ///< whose scan was processed last
  Time last_estimate_{0};       ///< the time of the estimate after it
};

}  // namespace rio

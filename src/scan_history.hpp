// SPDX-License-Identifier: BSD-3-Clause
// What each radar has sent so far: which scan is a new one, and which may be processed without an
// earlier one of another radar coming after it.
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
  /// @param wait a scan is held back so long for an earlier one of another radar [s]
  ScanHistory(std::size_t radars, double wait) : radars_(radars), wait_(from_seconds(wait)) {}

  /// Starts over, but for what the last scans looked like.
  /// @param now newest sample of the IMU; zero if there is none
  void forget(Time now);
  void forget_looks();

  /// The last one processed has this stamp.
  bool is_last(Time stamp, std::size_t radar) const {
    return of_[radar].processed && stamp == of_[radar].last;
  }
  /// The filtered scan is the one before it again: noise alone makes each another one. At rest all
  /// Dopplers of a coarse grid may be zero.
  bool is_repeated(const DetectionList& scan);
  /// It follows the scan processed last, of whose time the estimate still is.
  bool follows_last(Time stamp, std::size_t radar, Time estimate) const {
    const OfRadar& own = of_[radar];
    return own.processed && radar == last_radar_ && stamp > own.last && estimate == last_estimate_;
  }
  /// The IMU has reached it, and no other radar can have an earlier one: each has sent a later one,
  /// or has had the time for it, or is silent.
  /// @param now newest sample of the IMU
  bool is_ready(Time measured, std::size_t radar, Time now) const;

  /// A scan is taken, to be processed or to wait.
  /// @param now newest sample of the IMU, if there is one
  void take(std::size_t radar, Time measured, std::optional<Time> now);
  /// @param estimate its time afterwards
  void process(Time stamp, std::size_t radar, Time estimate);

 private:
  struct OfRadar {
    Time last{0};  ///< stamp of the last one processed
    bool processed = false;
    Time newest{0};                 ///< measurement time of the newest one taken
    Time heard{0};                  ///< newest sample of the IMU then, or at the start
    std::uint64_t fingerprint = 0;  ///< of the last scan taken or repeated
  };

  static constexpr Time kSilent = std::chrono::milliseconds(500);  // not waited for any more

  std::size_t radars_;
  Time wait_;
  std::array<OfRadar, kMaxRadars> of_;
  std::size_t last_radar_ = 0;  ///< whose scan was processed last
  Time last_estimate_{0};       ///< the time of the estimate after it
};

}  // namespace rio

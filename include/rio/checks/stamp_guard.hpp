// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: detects stamps that do not follow the one before. A single one is refused without
// further effect; a lasting run of rising ones means a pause of the sensor or a jump of its clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "rio/types.hpp"

namespace rio {

/// Valid stamps lie within 146 years of their epoch: differences and delays cannot overflow.
inline constexpr Time kFarthestStamp = Time::max() / 2 - std::chrono::hours(1);
constexpr bool is_stamp(Time time) {
  return time >= -kFarthestStamp && time <= kFarthestStamp;
}

enum class StampVerdict : std::uint8_t {
  kFollows,    ///< later than the newest accepted, by half a second at most, or after a pause
  kOld,        ///< not later than the newest accepted
  kAhead,      ///< later by more than half a second
  kRestarted,  ///< part of a lasting run: the clock has jumped
};

/// O(1) a stamp, no allocation.
class StampGuard {
 public:
  static constexpr Time kSudden = std::chrono::milliseconds(500);  ///< longest unsuspicious step

  /// @param max_pause a run that begins later than this after the newest stamp is a clock jump
  explicit StampGuard(Time max_pause) : max_pause_(max_pause) {}

  void reset() { *this = StampGuard{max_pause_}; }

  StampVerdict check(Time stamp);
  /// The sample with this stamp was accepted; the next stamps are compared with it.
  void take(Time stamp) {
    if (newest_ && run_ == 0) interval_ = stamp - *newest_;
    newest_ = seen_ = stamp;
    run_ = 0;
  }

  /// The newest accepted stamp in the clock of the run, if no sample was lost at the jump.
  Time newest_in_run() const { return first_ - interval_; }

 private:
  static constexpr int kMany = 5;  // stamps in a row that are no coincidence
  static constexpr Time kLasting = std::chrono::milliseconds(100);  // least span: no late data
  static constexpr Time kUsual = std::chrono::seconds(10);   // longest pause that is no surprise
  static constexpr Time kCertain = std::chrono::seconds(1);  // least span after a longer one

  Time max_pause_;
  std::optional<Time> newest_;
  Time seen_{0};      ///< the newest that followed, whether its sample was accepted or not
  Time interval_{0};  ///< between the last two accepted stamps that followed each other
  Time first_{0};     ///< of the run
  Time last_{0};      ///< of the run
  int run_ = 0;       ///< stamps in a row that did not follow the newest
};

}  // namespace rio

// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: stamps that do not follow the one before. A single odd one is refused, and nothing else
// comes of it; a lasting run of them, rising, is a pause of the sensor or a jump of its clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "rio/types.hpp"

namespace rio {

/// Stamps lie within 146 years of their epoch: differences and delays then cannot overflow.
inline constexpr Time kFarthestStamp = Time::max() / 2 - std::chrono::hours(1);
constexpr bool is_stamp(Time time) {
  return time >= -kFarthestStamp && time <= kFarthestStamp;
}

enum class StampVerdict : std::uint8_t {
  kFollows,    ///< later than the newest one taken, by half a second at most, or after a pause
  kOld,        ///< not later
  kAhead,      ///< later by more
  kRestarted,  ///< one of a run in another clock
};

/// O(1) a stamp, no allocation.
class StampGuard {
 public:
  /// @param max_pause a run that begins later than this after the newest stamp is another clock
  explicit StampGuard(Time max_pause) : max_pause_(max_pause) {}

  void reset() { *this = StampGuard{max_pause_}; }

  StampVerdict check(Time stamp);
  /// The sample with this stamp was taken; the next are held against it.
  void take(Time stamp);

  /// What the newest stamp taken is in the clock of the run, if no time has passed unseen.
  Time newest_in_run() const { return first_ - interval_; }

 private:
  static constexpr Time kSudden = std::chrono::milliseconds(500);  // longest step without a doubt
  static constexpr int kMany = 5;  // stamps in a row that are no accident
  static constexpr Time kLasting = std::chrono::milliseconds(100);  // length of a run: no old data

  Time max_pause_;
  std::optional<Time> newest_;
  Time seen_{0};      ///< the newest that followed, whether its sample was taken or not
  Time interval_{0};  ///< of the last two stamps taken that followed each other
  Time first_{0};     ///< of the run
  Time last_{0};      ///< of the run
  int run_ = 0;       ///< stamps in a row that did not follow the newest
};

}  // namespace rio
